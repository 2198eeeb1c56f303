// Frames in a window on the screen, with a few keys.
#pragma once

#include "pipeline/sink.h"
#include "pipeline/sinks/draw_frame.h"

#include <functional>
#include <string>

namespace eventide {

struct WindowSettings {
    std::string title = "eventide";
    Uncertainty uncertainty =
        Uncertainty::automatic;  ///< at the beginning; key u goes on from there
    float sigma_white = kSigmaWhite;
    /// Told the new factor when + or - is pressed; may be empty (live sources have one speed).
    std::function<void(double)> speed_changed = {};
    double speed = 1;  ///< at the beginning
    /// Asked while paused: true ends the pause, because the run is being stopped. May be empty.
    std::function<bool()> give_up = {};
    bool events = false;  ///< left of the image; other sinks may want Frame::event_preview, too
    ShownPart part = {};  ///< that frames show
};

/// Throws Error (usage) when there is no display, or none that answers.
void require_display();

/// What the keys have set. Apart from the window, so that it can be tested without one.
struct WindowControls {
    bool paused = false, closed = false;
    Uncertainty uncertainty = Uncertainty::none;
    double speed = 1;

    /// space pause, u next way of showing sigma (none, side, overlay), + and - speed by 2, q or
    /// Escape quit; -1 is no key, others do nothing.
    void press(int key);
};

/// Where asked for, frames with an event preview show it left of the image.
///
/// Render thread = the program's main thread, as window systems want it. A pause holds the thread:
/// a recording waits; the windows of a live source are merged, and their frames come late or are
/// skipped.
class WindowSink : public Sink {
public:
    /// Throws as require_display().
    explicit WindowSink(WindowSettings settings);
    ~WindowSink() override;
    WindowSink(const WindowSink&) = delete;
    WindowSink& operator=(const WindowSink&) = delete;

    void write(const Frame& frame) override;
    void close() override;
    bool wants_more() const override { return !controls_.closed; }
    HostTime::duration held() const override { return held_; }

private:
    void show(const Frame& frame);
    void react(int wait_ms);

    WindowSettings settings_;
    HostTime::duration held_{};
    WindowControls controls_;
    cv::Mat image_;
    bool open_ = false;
};

}  // namespace eventide
