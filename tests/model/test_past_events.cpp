// Events of the last 200 ms, pixel by pixel.
#include "src/model/render/past_events.h"
#include "tests/model/fusion_images.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

using namespace test;

double since(const PastEvents& past, double ms) {
    Array2<float> sum(1, 2);
    past.add_since(at_ms(ms), 2, sum);
    EXPECT_FLOAT_EQ(sum(0, 1), 3 * sum(0, 0));
    return sum(0, 0) / 2;
}

/// Windows so wide until `now_ms`, of `events(end_ms)` of the first pixel, three times as many of
/// the second.
template <typename Events>
void remember(PastEvents& past, double width_ms, double now_ms, const Events& events) {
    for (int i = 1; i * width_ms <= now_ms; ++i) {
        Array2<float> each(1, 2);
        each(0, 0) = events(i * width_ms);
        each(0, 1) = 3 * each(0, 0);
        past.remember({at_ms((i - 1) * width_ms), at_ms(i * width_ms)}, each);
    }
}

TEST(PastEvents, ThatComeEvenlyAreThoseSinceAnyTime) {
    for (const double width_ms : {1., 7., 18.2, 19., 50., 120.}) {
        PastEvents past{2, 1};
        const double now = int(1500 / width_ms) * width_ms;
        remember(past, width_ms, now, [&](double) { return float(width_ms); });
        for (const double ago : {0., .5, 5., 33., 100., 151., 200.})
            EXPECT_NEAR(since(past, now - ago), ago, .01) << width_ms;
        EXPECT_EQ(since(past, now + 10), 0);
        past.reset();
        EXPECT_EQ(since(past, 0), 0);
        past.remember({at_ms(0), at_ms(10)}, constant(5, 1, 2));
        Array2<float> sum(1, 2);
        past.add_since(at_ms(8), 1, sum);
        EXPECT_FLOAT_EQ(sum(0, 0), 1) << "of the windows after the reset alone";
    }
}

TEST(PastEvents, CameBeforeTheFirstWindowAsOftenAsSince) {
    PastEvents past{2, 1};
    EXPECT_EQ(since(past, 0), 0);
    remember(past, 10, 30, [](double end_ms) { return end_ms == 10 ? 3.F : 6.F; });
    EXPECT_FLOAT_EQ(float(since(past, 0)), 15);
    EXPECT_FLOAT_EQ(float(since(past, -20)), 25);
}

TEST(PastEvents, OfABurstAreKnownWithinTwentyMilliseconds) {
    for (int burst_ms = 30; burst_ms < 70; ++burst_ms) {
        PastEvents past{2, 1};
        remember(past, 1, 120, [&](double end_ms) { return end_ms == burst_ms ? 10.F : 0.F; });
        EXPECT_NEAR(since(past, burst_ms - 20), 10, 1e-4) << burst_ms;
        EXPECT_EQ(since(past, burst_ms + 20), 0) << burst_ms;
    }
}

}  // namespace
}  // namespace eventide
