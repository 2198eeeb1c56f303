// Frames as PNG and sigma as float TIFF in a folder, with their times beside them.
#include "pipeline/sinks/folder.h"

#include "src/core/duration_text.h"
#include "src/core/error.h"
#include "src/io/image_codecs.h"
#include "src/io/output_file.h"

#include <span>
#include <utility>
#include <vector>

namespace eventide {

namespace {

namespace fs = std::filesystem;

enum Kind : std::size_t { kFrames, kUncertainty, kEvents };  // as in files()

void write_image(const fs::path& file, const cv::Mat& image, const char* extension,
                 const std::vector<int>& options) {
    std::vector<unsigned char> bytes;
    bool encoded = false;
    std::string reason;
    try {
        encoded = encode_image(extension, image, bytes, options);
    } catch (const cv::Exception& error) {
        reason = std::string{": "} + error.what();
    }
    if (!encoded) throw Error(ErrorKind::failed, file.string() + ": cannot be encoded" + reason);
    write_file(file, std::as_bytes(std::span{bytes}), true);
}

}  // namespace

RunFolderFiles FolderSink::files() {
    return {{{"frames", "frame_", 10, ".png"},
             {"uncertainty", "unc_", 10, ".tiff"},
             {"events", "events_", 10, ".png"}},
            {"timestamps.txt", "timestamps.csv"},
            "timestamps.csv"};
}

FolderSink::FolderSink(FolderSettings settings)
    : settings_{std::move(settings)}, folder_{settings_.path, settings_.overwrite, files()} {
    load_image_codecs();
}

void FolderSink::begin() {
    if (table_) return;
    folder_.begin();
    const OutputOptions growing{.appears = Appears::growing};
    seconds_.emplace(settings_.path / "timestamps.txt", growing);
    table_.emplace(settings_.path / "timestamps.csv", growing);
    table_->write("frame,index,t_us,window_begin_us,window_end_us,events,lost\n");
}

void FolderSink::write(const Frame& frame) {
    // Level 1 takes a third of the time of the default for files a tenth larger.
    static const std::vector<int> kPng{cv::IMWRITE_PNG_COMPRESSION, 1};
    // 1 = not compressed: deflating float noise costs time and saves nothing.
    static const std::vector<int> kTiff{cv::IMWRITE_TIFF_COMPRESSION, 1};

    begin();
    draw(frame, settings_.uncertainty, settings_.sigma_white, image_);
    write_image(folder_.next(kFrames), image_, ".png", kPng);
    if (settings_.uncertainty != Uncertainty::none && !frame.sigma.empty()) {
        const cv::Mat sigma(frame.sigma.height(), frame.sigma.width(), CV_32FC1,
                            const_cast<float*>(frame.sigma.values().data()));
        write_image(folder_.next(kUncertainty), sigma, ".tiff", kTiff);
    }
    if (settings_.events && !frame.event_preview.empty()) {
        draw_events(frame, image_);
        write_image(folder_.next(kEvents), image_, ".png", kPng);
    }
    write_times(frame);
    ++frames_;
}

void FolderSink::write_times(const Frame& frame) {
    seconds_->write(seconds_text(frame.t) + "\n");
    std::string line;
    for (const std::int64_t n :
         {std::int64_t(frames_), std::int64_t(frame.index), to_us(frame.t),
          to_us(frame.window.begin), to_us(frame.window.end), std::int64_t(frame.events)})
        line += std::to_string(n) + ",";
    table_->write(line + std::to_string(settings_.lost ? settings_.lost() : 0) + "\n");
}

void FolderSink::close() {
    if (std::exchange(closed_, true)) return;
    if (folder_.holds_earlier_run()) return;  // there is no frame to put in its place
    begin();
    seconds_->close();
    table_->close();
    folder_.finish(settings_.run_json ? settings_.run_json() : "{}");
}

}  // namespace eventide
