// Adjustments of frames: each does one thing, and sigma stays in the units of intensity.
#include "pipeline/sinks/adjust.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace eventide {
namespace {

TEST(Adjustment, OffLeavesEveryNumberAlone) {
    const Frame frame = test::ramp_frame(9, 7, 2, test::odd_time(1));
    Adjustment adjust{{}};
    const Frame& shown = adjust.apply(frame);
    EXPECT_EQ(shown.intensity, frame.intensity);
    EXPECT_EQ(shown.sigma, frame.sigma);
    EXPECT_EQ(shown.t, frame.t);
    EXPECT_EQ(shown.index, frame.index);
    EXPECT_TRUE(AdjustSettings{}.changes_nothing());
}

TEST(Adjustment, FlippingTwiceIsNothing) {
    const Frame frame = test::ramp_frame(9, 7, 2, from_us(0));
    for (const Flip flip : {Flip::horizontal, Flip::vertical, Flip::both}) {
        Adjustment there{{.flip = flip}}, back{{.flip = flip}};
        const Frame& once = there.apply(frame);
        EXPECT_NE(once.intensity, frame.intensity);
        EXPECT_EQ(back.apply(once).intensity, frame.intensity);
        EXPECT_EQ(back.apply(once).sigma, frame.sigma);
    }
}

TEST(Adjustment, FlipHorizontalMirrorsLeftAndRight) {
    const Frame frame = test::ramp_frame(9, 7, 2, from_us(0));
    Adjustment adjust{{.flip = Flip::horizontal}};
    EXPECT_EQ(adjust.apply(frame).intensity(3, 0), frame.intensity(3, 8));
}

TEST(Adjustment, CropsTheBorderOrSaysThatNothingIsLeft) {
    const Frame frame = test::ramp_frame(9, 7, 2, from_us(0));
    Adjustment adjust{{.crop_px = 2}};
    const Frame& shown = adjust.apply(frame);
    EXPECT_EQ(shown.intensity.width(), 5);
    EXPECT_EQ(shown.intensity.height(), 3);
    EXPECT_EQ(shown.sigma(0, 0), frame.sigma(2, 2));
    Adjustment too_much{{.crop_px = 4}};
    EXPECT_THROW(too_much.apply(frame), Error);
}

TEST(Adjustment, AutoHdrFillsTheRangeAndScalesSigmaAlike) {
    Frame frame = test::ramp_frame(100, 100, 0, from_us(0));
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x) {
            frame.intensity(y, x) = 0.4f + 0.002f * float(x);
            frame.sigma(y, x) = 0.01f;
        }
    Adjustment adjust{{.auto_hdr = true}};
    const Frame& shown = adjust.apply(frame);
    EXPECT_NEAR(shown.intensity(50, 1), 0, 0.02);
    EXPECT_NEAR(shown.intensity(50, 98), 1, 0.02);
    EXPECT_NEAR(shown.sigma(0, 0), 0.01 / 0.196, 0.002);
}

TEST(Adjustment, AutoHdrDoesNotBlowUpAFlatImage) {
    Frame frame = test::ramp_frame(10, 10, 0, from_us(0));
    for (float& v : frame.intensity.values()) v = 0.5f;
    Adjustment adjust{{.auto_hdr = true}};
    for (const float v : adjust.apply(frame).intensity.values()) EXPECT_NEAR(v, 0.5f, 0.01f);
}

TEST(Adjustment, AutoHdrForgetsBySensorTimeWhateverTheFrameRate) {
    Array2<float> dark{10, 10}, bright{10, 10};
    for (int i = 0; i < 100; ++i) {
        dark.values()[std::size_t(i)] = float(i % 10) / 20;
        bright.values()[std::size_t(i)] = 0.5f + float(i % 10) / 20;
    }
    const auto after_a_second = [&](int steps) {
        AutoRange range;
        range.update(from_us(0), dark);
        AutoRange::Range last;
        for (int i = 1; i <= steps; ++i)
            last = range.update(from_us(1'000'000 * i / steps), bright);
        return last;
    };
    EXPECT_NEAR(after_a_second(10).low, after_a_second(1000).low, 0.001);
    EXPECT_GT(after_a_second(10).low, 0.4);
}

/// A network begins with grey.
TEST(Adjustment, AutoHdrDoesNotStretchTheFirstHalfSecondByTheFirstFrame) {
    Array2<float> grey{10, 10}, full{10, 10};
    for (int i = 0; i < 100; ++i) {
        grey.values()[std::size_t(i)] = 0.5f;
        full.values()[std::size_t(i)] = float(i % 10) / 9;
    }
    AutoRange range;
    range.update(from_us(0), grey);
    for (int frame = 1; frame < 4; ++frame) {
        const AutoRange::Range found = range.update(from_us(33'333 * frame), full);
        EXPECT_NEAR(found.low, 0, 0.01);
        EXPECT_NEAR(found.high, 1, 0.01);
    }
}

TEST(Adjustment, AutoHdrSmoothsFromTheFirstFramesOn) {
    Array2<float> dark{10, 10}, bright{10, 10};
    for (float& v : bright.values()) v = 1;
    AutoRange range;
    range.update(from_us(0), dark);
    range.update(from_us(10'000), dark);
    const AutoRange::Range found = range.update(from_us(20'000), bright);
    EXPECT_NEAR((found.low + found.high) / 2, 0.5, 0.01);  // the mean of two frames
}

TEST(Adjustment, AutoHdrBeginsAnewWhereTheSensorsClockGoesBack) {
    Array2<float> dark{10, 10}, bright{10, 10};
    for (float& v : bright.values()) v = 1;
    AutoRange range, fresh;
    range.update(from_us(10'000'000), dark);
    const AutoRange::Range after = range.update(from_us(0), bright),
                           expected = fresh.update(from_us(0), bright);
    EXPECT_EQ(after.low, expected.low);
    EXPECT_EQ(after.high, expected.high);
}

TEST(Adjustment, TheEventsOfAFrameAreMirroredWithItAndNotCut) {
    Frame frame = test::ramp_frame(6, 6, 0, from_us(0));
    frame.event_preview = Array2<float>{2, 3};
    frame.event_preview(0, 0) = 1;
    Adjustment adjust{{.flip = Flip::both, .crop_px = 1}};
    const Array2<float>& events = adjust.apply(frame).event_preview;
    ASSERT_EQ(events.height(), 2);
    ASSERT_EQ(events.width(), 3);
    EXPECT_EQ(events(1, 2), 1);
    EXPECT_EQ(events(0, 0), 0);
}

TEST(Adjustment, UnsharpLeavesFlatPartsAndLiftsEdges) {
    Frame frame = test::ramp_frame(40, 40, 0, from_us(0));
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x) frame.intensity(y, x) = x < 20 ? 0.3f : 0.6f;
    Adjustment adjust{{.unsharp = 0.5f}};
    const Frame& shown = adjust.apply(frame);
    EXPECT_NEAR(shown.intensity(20, 5), 0.3, 1e-5);
    EXPECT_GT(shown.intensity(20, 20), 0.63);
    EXPECT_LT(shown.intensity(20, 19), 0.27);
}

struct Spy : Sink {
    int frames = 0, closed = 0, lookahead = 0;
    bool wants = true, watched = true;
    void write(const Frame&) override { ++frames; }
    void lookahead_is(int windows) override { lookahead = windows; }
    void close() override { ++closed; }
    bool wants_more() const override { return wants; }
    bool is_watched() const override { return watched; }
    HostTime::duration held() const override { return std::chrono::seconds{1}; }
};

TEST(AdjustSink, HandsEachFrameToAllAndEndsWithTheFirstThatHasEnough) {
    auto first = std::make_unique<Spy>(), second = std::make_unique<Spy>();
    Spy &a = *first, &b = *second;
    std::vector<std::unique_ptr<Sink>> behind;
    behind.push_back(std::move(first));
    behind.push_back(std::move(second));
    AdjustSink sink{{.flip = Flip::both}, std::move(behind)};
    sink.write(test::ramp_frame(4, 4, 0, from_us(0)));
    EXPECT_EQ(a.frames + b.frames, 2);
    sink.lookahead_is(2);
    EXPECT_EQ(a.lookahead + b.lookahead, 4);
    EXPECT_TRUE(sink.wants_more());
    EXPECT_EQ(sink.held(), std::chrono::seconds{2});
    a.watched = false;
    EXPECT_TRUE(sink.is_watched()) << "the other one is";
    b.watched = false;
    EXPECT_FALSE(sink.is_watched());
    b.wants = false;
    EXPECT_FALSE(sink.wants_more());
    sink.close();
    EXPECT_EQ(a.closed + b.closed, 2);
}

}  // namespace
}  // namespace eventide
