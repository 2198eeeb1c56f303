// What viewers of the live page may change, by what else a run does; and how the page is named.
#include "apps/cli/run/live_controls.h"
#include "apps/cli/run/open_sinks.h"
#include "apps/cli/run/quality/run_quality.h"
#include "apps/cli/run/run_plan.h"
#include "apps/cli/settings/sink_name.h"
#include "src/core/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace eventide::app {
namespace {

using testing::HasSubstr;

class LiveControls : public testing::Test {
protected:
    LiveControls() { settings_.out = {"http:0"}; }

    std::vector<HttpControl> made() {
        LiveControlsPlan plan{settings_, changes_, sensor_};
        plan.fps = fps_;
        plan.speed = speed_;
        if (speed_ > 0) plan.set_speed = [this](double factor) { speed_ = factor; };
        plan.live = live_;
        plan.slicer = parse_window(window_);
        return live_controls(plan);
    }
    HttpControl control(const std::string& name) {
        const auto all = made();
        return *std::ranges::find(all, name, &HttpControl::name);
    }

    RunSettings settings_;
    LiveChanges changes_;
    Size sensor_{240, 180};
    double fps_ = 30, speed_ = 1;
    std::string window_ = "50ms";
    bool live_ = false;
};

TEST_F(LiveControls, TellTheLineWhatIsWanted) {
    const HttpControl fps = control("fps"), scale = control("scale"),
                      lookahead = control("lookahead");
    EXPECT_EQ(fps.get(), 30);
    fps.set(120);
    scale.set(1.5);
    lookahead.set(1);
    const LiveChanges::Wanted wanted = changes_.take();
    EXPECT_EQ(wanted.rate, (FrameRate{120, 1}));
    EXPECT_EQ(wanted.size->width, 360);
    EXPECT_EQ(wanted.size->height, 270);
    EXPECT_EQ(wanted.lookahead, 1);
    EXPECT_EQ(fps.get(), 120);
    EXPECT_FALSE(changes_.take().rate) << "once";
}

/// Else a slider would show another value than the run has.
TEST_F(LiveControls, ReachToWhereTheRunBegan) {
    EXPECT_EQ(control("fps").most, 1000);
    fps_ = 2500.5;
    EXPECT_EQ(control("fps").most, 2501);
    for (const double speed : {.01, 20.0}) {
        speed_ = speed;
        EXPECT_LE(control("speed").least, speed);
        EXPECT_GE(control("speed").most, speed);
    }
    settings_.size.scale = 6.1;
    EXPECT_EQ(control("scale").most, 6.25);
}

TEST_F(LiveControls, LeaveAPixelOfASensorOfFew) {
    sensor_ = {1, 1};
    control("scale").set(.25);
    const LiveChanges::Wanted wanted = changes_.take();
    EXPECT_EQ(wanted.size->width, 1);
    EXPECT_EQ(wanted.size->height, 1);
}

TEST_F(LiveControls, AreWhatTheQualitySaysItIs) {
    RunQuality::Place place;
    place.sensor.width = 240;
    place.sensor.height = 180;
    RunQuality quality{settings_, place, {}};
    quality.tell_rate(30);
    auto all = made();
    quality.follow(all, changes_);
    std::ranges::find(all, "fps", &HttpControl::name)->set(60);
    const HttpControl scale = *std::ranges::find(all, "scale", &HttpControl::name);
    scale.set(.5);
    EXPECT_EQ(quality.state().frames_per_second, 60);
    EXPECT_EQ(quality.state().level.scale, .5);
    EXPECT_EQ(scale.get(), .5);
    EXPECT_EQ(changes_.take().size->width, 120);
}

TEST_F(LiveControls, CountFramesOfTheVideoInSlowMotion) {
    settings_.slow = 10;
    control("fps").set(60);
    EXPECT_EQ(changes_.take().rate, (FrameRate{600, 1}));
}

/// Of several changes in one request none is made where one is refused, so each has to be known to
/// be possible before.
TEST_F(LiveControls, OfferNoRateThatSlowMotionCannotHave) {
    for (const auto& [slow, most] :
         {std::pair{1., 1000.}, {1000., 1000.}, {3000., 333.}, {1e5, 10.}}) {
        settings_.slow = slow;
        const HttpControl fps = control("fps");
        EXPECT_EQ(fps.most, most) << slow;
        EXPECT_NO_THROW(fps.set(fps.most)) << slow;
    }
}

TEST_F(LiveControls, LeaveFramesAloneThatMustBeAlike) {
    for (const char* sink : {"video.mp4", "frames/", "y4m:x", "v4l2:/dev/video9"}) {
        settings_.out = {"http:0", sink};
        for (const char* name : {"fps", "scale"}) {
            EXPECT_FALSE(control(name).set) << sink;
            EXPECT_THAT(control(name).fixed, HasSubstr(sink));
        }
        EXPECT_TRUE(control("lookahead").set) << sink;
    }
    settings_.out = {"http:0", "null", "window"};
    EXPECT_TRUE(control("fps").set && control("scale").set);
}

TEST_F(LiveControls, SayWhatCannotBeChanged) {
    window_ = "aps";
    EXPECT_FALSE(control("window").set);
    EXPECT_EQ(control("window").text, "aps,1s");
    EXPECT_THAT(control("window").fixed, HasSubstr("images"));
    EXPECT_TRUE(control("speed").set);
    control("speed").set(0.5);
    EXPECT_EQ(speed_, 0.5);
    live_ = true;
    EXPECT_EQ(control("speed").fixed, "a camera has one speed");
    live_ = false;
    speed_ = 0;
    EXPECT_THAT(control("speed").fixed, HasSubstr("--speed max"));
    settings_.region = Region{0, 0, 10, 10};
    EXPECT_FALSE(control("scale").set);
    settings_.region.reset();
    settings_.size.exact = Size{640, 480};
    EXPECT_FALSE(control("scale").set);
}

TEST_F(LiveControls, MoveTheWindowInTheUnitOfItsRule) {
    const auto moved = [this](const char* window, double at_start, double to) {
        window_ = window;
        const HttpControl slider = control("window");
        EXPECT_EQ(slider.get(), at_start) << window;
        EXPECT_LE(slider.least, at_start);
        EXPECT_GE(slider.most, at_start);
        slider.set(to);
        EXPECT_EQ(slider.get(), to);
        const auto wanted = changes_.take_window();
        EXPECT_TRUE(wanted);
        EXPECT_FALSE(changes_.take_window()) << "once";
        return wanted.value_or(SlicerSettings{});
    };
    EXPECT_EQ(window_text(moved("50ms", 50, 20)), "20ms");
    EXPECT_EQ(window_text(moved("250us", 0.25, 4.25)), "4250us");
    EXPECT_EQ(window_text(moved("2s", 2000, 1)), "1ms");
    EXPECT_EQ(window_text(moved("20000ev,200ms", 20'000, 500)), "500ev,200ms");
    EXPECT_EQ(window_text(moved("0.35epp", 0.35, 1)), "1epp,100ms");
    const SlicerSettings content = moved("auto", 0.4, 2);
    EXPECT_EQ(content.rule, WindowRule::content);
    EXPECT_EQ(content.events_per_pixel, 2);
    EXPECT_EQ(content.max_width, SensorDuration{100'000});
    EXPECT_EQ(control("window").unit, "events per pixel where most moves");
}

/// A run that lengthened its windows under load keeps them as long; a viewer changes how much has
/// to happen in one, not how soon one may end.
TEST_F(LiveControls, LeaveHowSoonWindowsEndAsTheLoadHasIt) {
    window_ = "auto,50ms,2ms";
    LiveControlsPlan plan{settings_, changes_, sensor_};
    plan.slicer = parse_window(window_);
    SensorDuration now{0};
    plan.min_window = [&now] { return now; };
    const HttpControl window = live_controls(plan).back();
    ASSERT_EQ(window.name, "window");
    window.set(1);
    EXPECT_EQ(window_text(*changes_.take_window()), "auto,50ms,2ms") << "nothing follows the load";
    now = SensorDuration{20'000};
    window.set(1);
    EXPECT_EQ(window_text(*changes_.take_window()), "auto,50ms,20ms");
}

TEST(HttpName, IsASink) {
    EXPECT_EQ(parse_sink("http:127.0.0.1:8080").kind, SinkKind::http);
    EXPECT_EQ(parse_sink("http:").kind, SinkKind::http);
    EXPECT_EQ(parse_sink("http:[::1]:0").path, "[::1]:0");
    try {
        parse_sink("http://127.0.0.1:8080/");
        FAIL() << "what browsers write is no address of ours";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_THAT(error.what(), HasSubstr("http:127.0.0.1:8080"));
    }
}

TEST(HttpName, PlaysRecordingsAtTheirPace) {
    RunSettings settings;
    settings.out = {"http:8080"};
    EXPECT_EQ(speed_of(settings), 1);
    settings.speed = "max";
    EXPECT_EQ(speed_of(settings), 0);
}

}  // namespace
}  // namespace eventide::app
