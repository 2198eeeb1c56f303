// Frames as H.264 in MP4 or Matroska, each with its own exact time.
#include "pipeline/sinks/video.h"

#include "pipeline/sinks/new_file.h"
#include "pipeline/sinks/video_file.h"
#include "src/core/error.h"

#include <cmath>
#include <utility>

namespace eventide {

namespace {

/// x.mp4 -> x.sigma.mp4
std::filesystem::path beside(std::filesystem::path path) {
    const std::string extension = path.extension().string();
    return path.replace_extension(".sigma" + extension);
}

std::unique_ptr<VideoFile> create(const std::filesystem::path& path,
                                  const VideoSettings& settings) {
    refuse_existing(path, settings.overwrite);
    return std::make_unique<VideoFile>(
        path, EncoderSettings{settings.preset, settings.crf, settings.fps});
}

}  // namespace

VideoSink::VideoSink(VideoSettings settings) : settings_{std::move(settings)} {
    if (settings_.uncertainty == Uncertainty::alpha)
        throw Error(ErrorKind::usage, settings_.path.string() +
                                          ": H.264 has no transparency; expected --uncertainty "
                                          "none, separate, side or overlay, found alpha");
    intensity_ = create(settings_.path, settings_);
    if (settings_.uncertainty == Uncertainty::separate)
        sigma_ = create(beside(settings_.path), settings_);
}

VideoSink::~VideoSink() = default;

std::int64_t VideoSink::microseconds_after_first(SensorTime t) {
    if (last_us_ < 0) origin_ = t;
    if ((t - origin_).count() <= last_us_)
        origin_ = t - SensorDuration{last_us_ + std::llround(1e6 / settings_.fps)};
    last_us_ = (t - origin_).count();
    return last_us_;
}

void VideoSink::write(const Frame& frame) {
    const std::int64_t t_us = microseconds_after_first(frame.t);
    draw(frame, settings_.uncertainty, settings_.sigma_white, picture_);
    intensity_->write(picture_, t_us);
    if (!sigma_) return;
    draw_sigma(frame, settings_.sigma_white, picture_);
    sigma_->write(picture_, t_us);
}

void VideoSink::close() {
    intensity_->finish();
    if (sigma_) sigma_->finish();
}

}  // namespace eventide
