// Frames as H.264 in MP4 or Matroska, each with its own exact time.
#include "pipeline/sinks/video/video.h"

#include "pipeline/first_error.h"
#include "pipeline/sinks/video/video_file.h"
#include "pipeline/sinks/video/video_kind.h"
#include "src/core/error.h"

#include <opencv2/core.hpp>

#include <cmath>
#include <utility>

namespace eventide {

namespace {

std::unique_ptr<VideoFile> create(const std::filesystem::path& path,
                                  const VideoSettings& settings) {
    return std::make_unique<VideoFile>(
        path, EncoderSettings{settings.preset, settings.crf, settings.fps,
                              OutputOptions{.overwrite = settings.overwrite,
                                            .appears = Appears::growing,
                                            .give_up = settings.give_up,
                                            .unread = settings.unread}});
}

}  // namespace

VideoSink::VideoSink(VideoSettings settings) : settings_{std::move(settings)} {
    const bool colour = video_kind_of(settings_.path).colour;
    if (settings_.uncertainty == Uncertainty::alpha)
        throw Error(ErrorKind::usage,
                    settings_.path.string() +
                        ": its frames have no transparency; expected --uncertainty none, "
                        "separate" +
                        (colour ? ", side or overlay" : " or side") + ", found alpha");
    if (settings_.uncertainty == Uncertainty::overlay && !colour)
        throw Error(ErrorKind::usage, settings_.path.string() +
                                          ": its 256 colours are greys; expected --uncertainty "
                                          "none, separate or side, found overlay");
    intensity_ = create(settings_.path, settings_);
    if (settings_.uncertainty == Uncertainty::separate)
        sigma_ = create(sigma_path(settings_.path), settings_);
}

VideoSink::~VideoSink() = default;

std::int64_t VideoSink::microseconds_to_show(SensorTime t) {
    if (!last_) origin_ = t;
    const auto shown_us = [&](SensorTime at) {
        return begin_us_ + std::llround(double((at - origin_).count()) * settings_.slow);
    };
    if (last_ && t <= *last_) {  // the sensor's clock went back
        begin_us_ = shown_us(*last_) + std::llround(1e6 / settings_.fps);
        origin_ = t;
    }
    last_ = t;
    return shown_us(t);
}

bool VideoSink::is_watched() const {
    return intensity_->is_read() || (sigma_ && sigma_->is_read());
}

void VideoSink::write(const Frame& frame) {
    if (!is_watched()) return;
    const std::int64_t t_us = microseconds_to_show(frame.t);
    draw(frame, settings_.uncertainty, settings_.sigma_white, image_);
    if (settings_.events) draw_events_beside(frame, settings_.part, image_);
    if (!video_kind_of(settings_.path).colour && image_.channels() == 3)
        cv::extractChannel(image_, image_, 2);  // of events' red and blue: a light and a dark grey
    intensity_->write(image_, t_us);
    if (sigma_) {
        draw_sigma(frame, settings_.sigma_white, image_);
        sigma_->write(image_, t_us);
    }
}

void VideoSink::close() {
    FirstError error;  // both have an end, whatever happens to the other
    error.guard([&] { intensity_->finish(); });
    if (sigma_) error.guard([&] { sigma_->finish(); });
    error.rethrow_if_any();
}

}  // namespace eventide
