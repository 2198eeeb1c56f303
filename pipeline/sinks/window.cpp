// Frames in a window on the screen, through OpenCV's HighGUI.
#include "pipeline/sinks/window.h"

#include "pipeline/sinks/highgui.h"
#include "src/core/environment.h"
#include "src/core/error.h"

#include <dlfcn.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace eventide {

namespace {

std::string_view environment(const char* name) {
    const char* value = environment_value(name);
    return value == nullptr ? std::string_view{} : std::string_view{value};
}

/// Asks the X server itself: a DISPLAY may be set and nobody be there. Without libX11 the question
/// stays open, and HighGUI will ask.
bool x_server_answers() {
    void* library = dlopen("libX11.so.6", RTLD_LAZY | RTLD_LOCAL);
    if (library == nullptr) return true;
    const auto open = reinterpret_cast<void* (*)(const char*)>(dlsym(library, "XOpenDisplay"));
    const auto close = reinterpret_cast<int (*)(void*)>(dlsym(library, "XCloseDisplay"));
    if (open == nullptr || close == nullptr) return true;
    void* display = open(nullptr);
    if (display != nullptr) close(display);
    return display != nullptr;
}

}  // namespace

// HighGUI's Qt ends the whole program where there is no display, so we look before it does.
void require_display() {
    const std::string_view platform = environment("QT_QPA_PLATFORM");
    if (platform.starts_with("offscreen") || platform.starts_with("minimal")) return;
    if (!environment("WAYLAND_DISPLAY").empty()) return;
    const std::string_view display = environment("DISPLAY");
    if (display.empty())
        throw Error(ErrorKind::usage,
                    "--out window: expected a display, found neither DISPLAY nor WAYLAND_DISPLAY; "
                    "write to a file (--out video.mp4) or a pipe (--out -) instead");
    if (!x_server_answers())
        throw Error(ErrorKind::usage, "--out window: the display " + std::string{display} +
                                          " does not answer; write to a file or a pipe instead");
}

void WindowControls::press(int key) {
    switch (key) {
        case ' ':
            paused = !paused;
            return;
        case 'u':
            uncertainty = uncertainty == Uncertainty::side      ? Uncertainty::overlay
                          : uncertainty == Uncertainty::overlay ? Uncertainty::none
                                                                : Uncertainty::side;
            return;
        case '+':
        case '=':  // the same key without shift
            speed = std::min(speed * 2, 64.0);
            return;
        case '-':
            speed = std::max(speed / 2, 1.0 / 64);
            return;
        case 'q':
        case 27:  // Escape
            closed = true;
            return;
        default:
            return;
    }
}

WindowSink::WindowSink(WindowSettings settings) : settings_{std::move(settings)} {
    require_display();
    highgui();  // loaded
    if (settings_.uncertainty == Uncertainty::alpha ||
        settings_.uncertainty == Uncertainty::separate)
        throw Error(ErrorKind::usage,
                    "--out window: expected --uncertainty none, side or overlay, found " +
                        std::string{name_of(settings_.uncertainty)});
    controls_.uncertainty =
        settings_.uncertainty == Uncertainty::automatic ? Uncertainty::none : settings_.uncertainty;
    controls_.speed = settings_.speed;
}

WindowSink::~WindowSink() {
    WindowSink::close();
}

void WindowSink::write(const Frame& frame) {
    if (controls_.closed) return;
    show(frame);
    react(1);
    const HostTime shown = HostTime::clock::now();
    while (controls_.paused && !controls_.closed && !(settings_.give_up && settings_.give_up())) {
        react(20);
        show(frame);
    }
    held_ = HostTime::clock::now() - shown;
}

void WindowSink::show(const Frame& frame) {
    draw(frame, controls_.uncertainty, settings_.sigma_white, image_);
    if (settings_.events) draw_events_beside(frame, settings_.part, image_);
    if (!open_) {
        highgui().named_window(settings_.title, cv::WINDOW_NORMAL | cv::WINDOW_KEEPRATIO);
        highgui().resize_window(settings_.title, std::max(640, image_.cols),
                                std::max(640, image_.cols) * image_.rows / image_.cols);
        open_ = true;
    }
    highgui().show(settings_.title, image_);
}

void WindowSink::react(int wait_ms) {
    const double speed = controls_.speed;
    controls_.press(highgui().wait_key(wait_ms));
    if (speed != controls_.speed && settings_.speed_changed)
        settings_.speed_changed(controls_.speed);
    if (highgui().window_property(settings_.title, cv::WND_PROP_VISIBLE) == 0)
        controls_.closed = true;
}

void WindowSink::close() {
    if (!std::exchange(open_, false)) return;
    highgui().destroy_window(settings_.title);
}

}  // namespace eventide
