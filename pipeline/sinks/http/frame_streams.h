// Answers that go on and on: one frame after the other, for as long as the viewer takes them.
#pragma once

#include "pipeline/sinks/http/newest_frame.h"

#include <httplib.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace eventide {

struct MotionJpeg {
    Show show = Show::intensity;
    double fps = 60;  ///< at most
};

/// Throw Error (usage) for other words.
Show show_named(const std::string& word);
double rate_named(const std::string& word);  ///< 0.1 to 1000

/// Sends the live page ShownFrame::message() of each frame, at most 60 per second. `place` is kept
/// until the viewer is gone.
void send_frames(NewestFrame& newest, std::shared_ptr<const void> place,
                 httplib::Response& response);

/// Sends programs multipart/x-mixed-replace, with the sensor's time in X-Timestamp. The last frame
/// comes again each second while there is no new one, because players give up on silence.
void send_motion_jpeg(NewestFrame& newest, const MotionJpeg& wanted,
                      std::shared_ptr<const void> place, httplib::Response& response);

/// Events per second of host time, over half a second at least: shorter spans jump.
class EventRate {
public:
    double at(std::chrono::steady_clock::time_point now, std::uint64_t events);

private:
    std::optional<std::chrono::steady_clock::time_point> last_;
    std::uint64_t events_ = 0;
    double rate_ = 0;
};

}  // namespace eventide
