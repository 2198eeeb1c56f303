// A recording as a folder in the manner of the Event Camera Dataset.
#include "src/app/ecd_writer.h"

#include "pipeline/sinks/new_file.h"
#include "replay/formats.h"
#include "src/core/error.h"

#include <opencv2/imgcodecs.hpp>

#include <cinttypes>
#include <cstdio>
#include <utility>

namespace eventide::app {

namespace fs = std::filesystem;

EcdWriter::EcdWriter(fs::path folder, bool overwrite, int width, int height)
    : folder_{std::move(folder)} {
    refuse_existing(folder_ / "images.txt", overwrite);
    std::error_code failed;
    fs::create_directories(folder_ / "images", failed);
    if (failed)
        throw Error(ErrorKind::failed, folder_.string() + ": cannot be made: " + failed.message());
    StreamHeader header;
    header.format = "text";
    header.width = width;
    header.height = height;
    events_ = std::make_unique<RecordingFile>((folder_ / "events.txt").string(), overwrite,
                                              open_writer("text"), header);
    list_.open(folder_ / "images.txt");
}

void EcdWriter::write(const Batch& batch) {
    Batch events;
    events.events = batch.events;
    if (!events.empty()) events_->write(events);
    for (const ReferenceImage& image : batch.images) {
        char name[64], seconds[48];
        std::snprintf(name, sizeof name, "images/frame_%08" PRIu64 ".png", images_++);
        std::snprintf(seconds, sizeof seconds, "%" PRId64 ".%06" PRId64, to_us(image.t) / 1'000'000,
                      to_us(image.t) % 1'000'000);
        const cv::Mat wide(image.pixels.height(), image.pixels.width(), CV_16UC1,
                           const_cast<std::uint16_t*>(image.pixels.values().data()));
        cv::Mat narrow;
        wide.convertTo(narrow, CV_8U, 1.0 / 257);
        list_ << seconds << ' ' << name << '\n' << std::flush;
        if (!cv::imwrite((folder_ / name).string(), narrow) || !list_)
            throw Error(ErrorKind::failed, (folder_ / name).string() + ": cannot be written");
    }
}

void EcdWriter::finish() {
    events_->finish();
}

}  // namespace eventide::app
