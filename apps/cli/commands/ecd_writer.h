// A recording as a folder in the manner of the Event Camera Dataset: events.txt, images.txt,
// images/, and exposure.txt with begin and end of each image's exposure.
#pragma once

#include "pipeline/sinks/run_folder.h"
#include "replay/recording_file.h"
#include "src/core/event.h"
#include "src/io/output_file.h"

#include <opencv2/core.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

namespace eventide::app {

class EcdWriter {
public:
    /// An earlier recording in the folder goes with the first event or image. Throws Error as
    /// RunFolder does.
    EcdWriter(const std::filesystem::path& folder, bool overwrite, int width, int height);

    /// What it writes.
    static RunFolderFiles files();

    /// Events and images; inertial samples and triggers have no place there.
    void write(const Batch& batch);
    void finish();
    std::uint64_t bytes_written() const {
        return events_ ? events_->bytes_written() + image_bytes_ : 0;
    }

private:
    void begin();
    void write(const ReferenceImage& image);
    cv::Mat covering_sensor(const ReferenceImage& image) const;

    int width_, height_;  // of the sensor
    std::uint64_t image_bytes_ = 0;
    RunFolder folder_;
    std::unique_ptr<RecordingFile> events_;  // both from the first event or image on
    std::optional<OutputFile> list_, exposures_;
};

}  // namespace eventide::app
