// What a window of training looks at.
#include "src/train/data.h"

#include <gtest/gtest.h>

#include <cmath>

namespace eventide {
namespace {

bool whole(double v) {
    return v == std::round(v);
}

/// Every plan stays inside the crop; returns how many of 400 have pixels for points.
int plans_on_pixels(int crop, int patch) {
    DataSettings settings;
    settings.crop = crop;
    settings.patch = patch;
    int on_pixels = 0;
    for (int window = 0; window < 400; ++window) {
        const WindowPlan plan = window_plan(settings, window);
        for (const double begin : {plan.y0, plan.x0}) {
            EXPECT_GE(begin, 0);
            EXPECT_LE(begin + plan.span, crop - 1 + 1e-9);
        }
        on_pixels += plan.span == patch - 1 && whole(plan.y0) && whole(plan.x0);
    }
    return on_pixels;
}

TEST(WindowPlan, PatchesLieInTheCropAndMostOnItsPixels) {
    const double share = DataSettings{}.whole_probability;
    for (const int patch : {64, 48, 17})
        EXPECT_NEAR(plans_on_pixels(64, patch) / 400.0, share, .1) << patch;
    EXPECT_EQ(plans_on_pixels(64, 90), 0) << "a patch of more points than the crop has pixels";
}

TEST(WindowPlan, IsTheSameForTheSameWindow) {
    const DataSettings settings;
    for (int window = 0; window < 20; ++window) {
        const WindowPlan a = window_plan(settings, window), b = window_plan(settings, window);
        EXPECT_EQ(a.span, b.span);
        EXPECT_EQ(a.y0, b.y0);
        EXPECT_EQ(a.x0, b.x0);
        EXPECT_EQ(a.lookahead, b.lookahead);
    }
}

}  // namespace
}  // namespace eventide
