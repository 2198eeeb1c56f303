// The window's keys, and what happens where there is no screen.
#include "pipeline/sinks/window.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace eventide {
namespace {

TEST(WindowControls, AnswerTheirKeys) {
    WindowControls controls;
    controls.press(-1);
    controls.press('x');
    EXPECT_FALSE(controls.paused || controls.closed);
    controls.press(' ');
    EXPECT_TRUE(controls.paused);
    controls.press(' ');
    EXPECT_FALSE(controls.paused);
    controls.press('u');
    EXPECT_EQ(controls.uncertainty, Uncertainty::side);
    controls.press('u');
    EXPECT_EQ(controls.uncertainty, Uncertainty::overlay);
    controls.press('u');
    EXPECT_EQ(controls.uncertainty, Uncertainty::none);
    controls.press('+');
    EXPECT_EQ(controls.speed, 2);
    for (int times = 0; times < 10; ++times) controls.press('+');
    EXPECT_EQ(controls.speed, 64) << "the most";
    controls.speed = 2;
    controls.press('-');
    controls.press('-');
    EXPECT_EQ(controls.speed, 0.5);
    controls.press('q');
    EXPECT_TRUE(controls.closed);
}

TEST(WindowSink, SaysClearlyThatThereIsNoDisplay) {
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"}) unsetenv(name);
    try {
        WindowSink sink{{}};
        FAIL() << "a window without a display";
    } catch (const Error& error) {
        EXPECT_NE(std::string{error.what()}.find("display"), std::string::npos);
        EXPECT_EQ(error.kind(), ErrorKind::usage);
    }
    setenv("DISPLAY", ":937", 1);
    EXPECT_THROW((WindowSink{{}}), Error);
    unsetenv("DISPLAY");
}

TEST(WindowSink, ShowsFramesOnAScreenNobodySees) {
    setenv("QT_QPA_PLATFORM", "offscreen", 1);
    WindowSink sink{{.uncertainty = Uncertainty::overlay, .events = true}};
    for (int n = 0; n < 3; ++n) {
        Frame frame = test::ramp_frame(64, 48, n, test::odd_time(n));
        frame.event_preview = Array2<float>{24, 32};
        sink.write(frame);
    }
    EXPECT_TRUE(sink.wants_more());
    sink.close();
}

}  // namespace
}  // namespace eventide
