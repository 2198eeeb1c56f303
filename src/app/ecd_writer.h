// A recording as a folder in the manner of the Event Camera Dataset: events.txt, images.txt,
// images/.
#pragma once

#include "replay/recording_file.h"
#include "src/core/event.h"

#include <filesystem>
#include <fstream>
#include <memory>

namespace eventide::app {

class EcdWriter {
public:
    /// Throws Error (usage) for a folder that holds something, without `overwrite`, (failed) when
    /// it cannot be made.
    EcdWriter(std::filesystem::path folder, bool overwrite, int width, int height);

    /// Events and images; inertial samples and triggers have no place there.
    void write(const Batch& batch);
    void finish();

private:
    std::filesystem::path folder_;
    std::unique_ptr<RecordingFile> events_;
    std::ofstream list_;
    std::uint64_t images_ = 0;
};

}  // namespace eventide::app
