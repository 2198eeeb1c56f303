// Frames as PNG and sigma as float TIFF in a folder, with their times beside them.
#include "pipeline/sinks/folder.h"

#include "src/core/error.h"

#include <opencv2/imgcodecs.hpp>

#include <cinttypes>
#include <cstdio>
#include <utility>
#include <vector>

namespace eventide {

namespace {

namespace fs = std::filesystem;

std::string numbered(const char* prefix, std::uint64_t n, const char* extension) {
    char name[64];
    std::snprintf(name, sizeof name, "%s%010" PRIu64 "%s", prefix, n, extension);
    return name;
}

/// Sensor time in seconds with all its microseconds: doubles lose them after 1970.
std::string seconds_of(SensorTime t) {
    const std::int64_t us = to_us(t);
    const std::uint64_t size = us < 0 ? std::uint64_t(0) - std::uint64_t(us) : std::uint64_t(us);
    char text[48];
    std::snprintf(text, sizeof text, "%s%" PRIu64 ".%06" PRIu64, us < 0 ? "-" : "",
                  size / 1'000'000, size % 1'000'000);
    return text;
}

bool holds_something(const fs::path& folder) {
    std::error_code unreadable;
    return fs::exists(folder) &&
           fs::directory_iterator{folder, unreadable} != fs::directory_iterator{};
}

void remove_numbered(const fs::path& folder, const std::string& prefix, const char* extension) {
    if (!fs::is_directory(folder)) return;
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator{folder})
        if (entry.path().filename().string().starts_with(prefix) &&
            entry.path().extension() == extension)
            old.push_back(entry.path());
    for (const fs::path& file : old) fs::remove(file);
}

/// What an earlier run wrote; nothing else in the folder is touched.
void remove_old_run(const fs::path& folder) {
    remove_numbered(folder / "frames", "frame_", ".png");
    remove_numbered(folder / "uncertainty", "unc_", ".tiff");
    remove_numbered(folder / "events", "events_", ".png");
    for (const char* name : {"timestamps.txt", "timestamps.csv", "run.json"})
        fs::remove(folder / name);
}

void prepare(const FolderSettings& settings) {
    const fs::path& folder = settings.path;
    if (fs::exists(folder) && !fs::is_directory(folder))
        throw Error(ErrorKind::usage, folder.string() + ": expected a folder, found a file");
    if (holds_something(folder)) {
        if (!settings.overwrite)
            throw Error(ErrorKind::usage,
                        folder.string() +
                            ": expected an empty or new folder, found one that holds something; "
                            "--overwrite replaces an earlier run");
        remove_old_run(folder);
    }
    fs::create_directories(folder / "frames");
    if (settings.uncertainty != Uncertainty::none) fs::create_directories(folder / "uncertainty");
}

void write_image(const fs::path& file, const cv::Mat& image, const std::vector<int>& options) {
    bool written = false;
    std::string reason = "is the disk full?";
    try {
        written = cv::imwrite(file.string(), image, options);
    } catch (const cv::Exception& error) {
        reason = error.what();
    }
    if (!written) throw Error(ErrorKind::failed, file.string() + ": cannot be written: " + reason);
}

std::ofstream create(const fs::path& file) {
    std::ofstream stream{file, std::ios::trunc};
    if (!stream) throw Error(ErrorKind::failed, file.string() + ": cannot be written");
    return stream;
}

}  // namespace

FolderSink::FolderSink(FolderSettings settings) : settings_{std::move(settings)} {
    try {
        prepare(settings_);
    } catch (const fs::filesystem_error& error) {
        throw Error(ErrorKind::failed,
                    settings_.path.string() + ": cannot be made: " + error.code().message());
    }
    seconds_ = create(settings_.path / "timestamps.txt");
    table_ = create(settings_.path / "timestamps.csv");
    table_ << "frame,index,t_us,window_begin_us,window_end_us,events,lost\n" << std::flush;
}

void FolderSink::write(const Frame& frame) {
    // Level 1 takes a third of the time of the default for files a tenth larger.
    static const std::vector<int> kPng{cv::IMWRITE_PNG_COMPRESSION, 1};
    // 1 = not compressed: deflating float noise costs time and saves nothing.
    static const std::vector<int> kTiff{cv::IMWRITE_TIFF_COMPRESSION, 1};

    draw(frame, settings_.uncertainty, settings_.sigma_white, picture_);
    write_image(settings_.path / "frames" / numbered("frame_", frames_, ".png"), picture_, kPng);
    if (settings_.uncertainty != Uncertainty::none && !frame.sigma.empty()) {
        const cv::Mat sigma(frame.sigma.height(), frame.sigma.width(), CV_32FC1,
                            const_cast<float*>(frame.sigma.values().data()));
        write_image(settings_.path / "uncertainty" / numbered("unc_", frames_, ".tiff"), sigma,
                    kTiff);
    }
    draw_events(frame, picture_);
    if (!picture_.empty()) {
        if (frames_ == 0) fs::create_directories(settings_.path / "events");
        write_image(settings_.path / "events" / numbered("events_", frames_, ".png"), picture_,
                    kPng);
    }
    write_times(frame);
    ++frames_;
}

void FolderSink::write_times(const Frame& frame) {
    seconds_ << seconds_of(frame.t) << '\n' << std::flush;
    table_ << frames_ << ',' << frame.index << ',' << to_us(frame.t) << ','
           << to_us(frame.window.begin) << ',' << to_us(frame.window.end) << ',' << frame.events
           << ',' << (settings_.lost ? settings_.lost() : 0) << '\n'
           << std::flush;
    if (!seconds_ || !table_)
        throw Error(ErrorKind::failed, (settings_.path / "timestamps.csv").string() +
                                           ": cannot be written: is the disk full?");
}

void FolderSink::close() {
    if (std::exchange(closed_, true) || !settings_.run_json) return;
    std::ofstream file = create(settings_.path / "run.json");
    file << settings_.run_json() << '\n' << std::flush;
    if (!file)
        throw Error(ErrorKind::failed, (settings_.path / "run.json").string() +
                                           ": cannot be written: is the disk full?");
}

}  // namespace eventide
