// Frames through lenses of known distortion: what comes out is what a camera without one would see.
#include "pipeline/calibration/undistortion.h"
#include "pipeline/calibration/undistortion_map.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/support/allocation_counter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core/utility.hpp>

#ifdef EVENTIDE_CALIB3D
#include <opencv2/calib3d.hpp>
#endif

#include <cmath>
#include <string>

namespace eventide {
namespace {

Calibration barrel() {
    Calibration c;
    c.width = 120;
    c.height = 90;
    c.distortion_model = "plumb_bob";
    c.d = {-0.3, 0.09, 0.002, -0.003, 0};
    c.k = {80, 0, 61.5, 0, 82, 43.5, 0, 0, 1};
    c.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    c.p = {80, 0, 61.5, 0, 0, 82, 43.5, 0, 0, 0, 1, 0};
    return c;
}

Calibration fisheye() {
    Calibration c = barrel();
    c.distortion_model = "equidistant";
    c.d = {-0.02, 0.01, -0.003, 0.001};
    return c;
}

Calibration rational() {
    Calibration c = barrel();
    c.distortion_model = "rational_polynomial";
    c.d = {0.4, 0.1, 0.001, -0.002, 0.01, 0.7, 0.15, 0.02};
    // One of a stereo pair, turned a little, and a wider view.
    const double a = 0.05;
    c.r = {std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a)};
    c.p = {70, 0, 58, -7, 0, 70, 45, 0, 0, 0, 1, 0};
    return c;
}

/// What there is to see along the ray (x, y, 1): smooth, 0 to 1.
double scene(double x, double y) {
    return 0.5 + 0.25 * std::sin(9 * x + 1) + 0.2 * std::cos(7 * y - 4 * x);
}

/// The pixel a ray falls on, by the equations of the manuals once more.
struct Pixel {
    double x, y;
};
Pixel seen_at(const Calibration& c, double x, double y) {
    double u, v;
    if (c.distortion_model == "equidistant") {
        const double r = std::hypot(x, y), t = std::atan(r);
        const double s = r == 0 ? 1
                                : (t + c.d[0] * std::pow(t, 3) + c.d[1] * std::pow(t, 5) +
                                   c.d[2] * std::pow(t, 7) + c.d[3] * std::pow(t, 9)) /
                                      r;
        u = x * s, v = y * s;
    } else {
        const double r2 = x * x + y * y;
        const double s = 1 + c.d[0] * r2 + c.d[1] * r2 * r2;
        u = x * s + 2 * c.d[2] * x * y + c.d[3] * (r2 + 2 * x * x);
        v = y * s + c.d[2] * (r2 + 2 * y * y) + 2 * c.d[3] * x * y;
    }
    return {c.k[0] * u + c.k[2], c.k[4] * v + c.k[5]};
}

/// The frame such a camera takes: for each pixel its ray is searched for by Newton's method with
/// the undistorted slope.
Frame taken(const Calibration& c) {
    Frame frame = test::ramp_frame(c.width, c.height, 0, from_us(7));
    for (int py = 0; py < c.height; ++py)
        for (int px = 0; px < c.width; ++px) {
            double x = (px - c.k[2]) / c.k[0], y = (py - c.k[5]) / c.k[4];
            for (int i = 0; i < 60; ++i) {
                const Pixel now = seen_at(c, x, y);
                x += 0.7 * (px - now.x) / c.k[0];
                y += 0.7 * (py - now.y) / c.k[4];
            }
            frame.intensity(py, px) = float(scene(x, y));
            frame.sigma(py, px) = 0.1f + 0.001f * float(px);
        }
    return frame;
}

double worst_against_scene(const Calibration& flat, const Frame& shown) {
    double worst = 0;
    int seen = 0;
    for (int y = 0; y < shown.intensity.height(); ++y)
        for (int x = 0; x < shown.intensity.width(); ++x) {
            if (shown.sigma(y, x) == Undistortion::kUnseen) continue;
            ++seen;
            const double truth = scene((x - flat.k[2]) / flat.k[0], (y - flat.k[5]) / flat.k[4]);
            worst = std::max(worst, std::abs(truth - double(shown.intensity(y, x))));
        }
    EXPECT_GT(seen, 3000);
    return worst;
}

TEST(Undistortion, ShowsWhatACameraWithoutDistortionSees) {
    for (const Calibration& camera : {barrel(), fisheye()}) {
        const Calibration sized = fitted(camera, {}, 300, 225);
        const Frame frame = taken(sized);
        Undistortion undistortion{plan_undistortion(camera, 300, 225, {})};
        EXPECT_LT(worst_against_scene(sized, undistortion.apply(frame)), 0.01)
            << camera.distortion_model;
        // The detector detects: the frame as it was taken is far off.
        EXPECT_GT(worst_against_scene(sized, frame), 0.1) << camera.distortion_model;
    }
}

TEST(Undistortion, KeepsTimeNumberAndSize) {
    const Frame frame = taken(barrel());
    Undistortion undistortion{plan_undistortion(barrel(), 120, 90, {})};
    const Frame& shown = undistortion.apply(frame);
    EXPECT_EQ(shown.t, frame.t);
    EXPECT_EQ(shown.events, frame.events);
    EXPECT_EQ(shown.intensity.width(), 120);
    EXPECT_EQ(shown.sigma.height(), 90);
    Frame plain = taken(barrel());
    plain.sigma = {};
    EXPECT_TRUE(undistortion.apply(plain).sigma.empty());
    // Sizes change while it runs.
    const Frame larger = taken(fitted(barrel(), {}, 240, 180));
    EXPECT_EQ(undistortion.apply(larger).intensity.width(), 240);
    EXPECT_LT(worst_against_scene(fitted(barrel(), {}, 240, 180), undistortion.apply(larger)),
              0.02);
}

TEST(Undistortion, EachColourIsItsOwn) {
    Frame frame = taken(barrel());
    for (std::size_t c = 0; c < frame.colour.size(); ++c) {
        frame.colour[c] = frame.intensity;
        for (float& v : frame.colour[c].values()) v *= .25F * float(c + 1);
    }
    Undistortion undistortion{plan_undistortion(barrel(), 120, 90, {})};
    const Frame& shown = undistortion.apply(frame);
    for (std::size_t c = 0; c < frame.colour.size(); ++c)
        EXPECT_NEAR(shown.colour[c](40, 50), .25F * float(c + 1) * shown.intensity(40, 50), 1e-5);
    EXPECT_TRUE(undistortion.apply(taken(barrel())).colour[1].empty());
}

TEST(Undistortion, ARegionIsTheSamePartOfTheWholeOutOfAPartOfTheFrame) {
    const Frame frame = taken(barrel());
    Undistortion whole{plan_undistortion(barrel(), 120, 90, {})};
    const UndistortionPlan plan = plan_undistortion(barrel(), 120, 90, {70, 10, 40, 30});
    ASSERT_LT(plan.source.width, 60) << "not all of the frame is needed";
    Frame part = frame;
    part.intensity = part.sigma = Array2<float>{plan.source.height, plan.source.width};
    for (int y = 0; y < plan.source.height; ++y)
        for (int x = 0; x < plan.source.width; ++x) {
            part.intensity(y, x) = frame.intensity(plan.source.y + y, plan.source.x + x);
            part.sigma(y, x) = frame.sigma(plan.source.y + y, plan.source.x + x);
        }
    Undistortion of_part{plan};
    const Frame &all = whole.apply(frame), &cut = of_part.apply(part);
    ASSERT_EQ(cut.intensity.width(), 40);
    ASSERT_EQ(cut.intensity.height(), 30);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            EXPECT_NEAR(cut.intensity(y, x), all.intensity(10 + y, 70 + x), 2e-6);
            EXPECT_NEAR(cut.sigma(y, x), all.sigma(10 + y, 70 + x), 2e-6);
        }
    EXPECT_THROW(plan_undistortion(barrel(), 120, 90, {100, 0, 40, 30}), Error);
}

TEST(Undistortion, WhatTheCameraDidNotSeeIsBlackAndUncertain) {
    Calibration wide = barrel();
    wide.p[0] = wide.p[5] = 30;  // a wider view than the lens has
    Undistortion undistortion{plan_undistortion(wide, 120, 90, {})};
    const Frame& shown = undistortion.apply(taken(barrel()));
    EXPECT_EQ(shown.intensity(0, 0), 0);
    EXPECT_EQ(shown.sigma(0, 0), Undistortion::kUnseen);
    EXPECT_NE(shown.sigma(45, 60), Undistortion::kUnseen);
    // Far out this lens model turns back and would show the middle once more.
    wide.d = {-0.3, 0, 0, 0, 0};
    wide.p[0] = wide.p[5] = 8;
    const SourcePlaces places = source_places(wide, {0, 0, 120, 90});
    EXPECT_EQ(places.x(43, 45), SourcePlaces::kNowhere) << "r = 2, behind the turn at 1.05";
    EXPECT_GT(places.x(43, 57), 0);
}

TEST(Undistortion, EventsMoveWithTheFrame) {
    Frame frame = taken(barrel());
    frame.event_preview = Array2<float>{90, 120};
    const Pixel seen = seen_at(barrel(), 0.55, 0.4);
    frame.event_preview(int(std::lround(seen.y)), int(std::lround(seen.x))) = 3;
    Undistortion undistortion{plan_undistortion(barrel(), 240, 180, {})};
    const Frame& shown = undistortion.apply(frame);
    const double x = 61.5 + 80 * 0.55, y = 43.5 + 82 * 0.4;
    float nearby = 0;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            nearby += shown.event_preview(int(std::lround(y)) + dy, int(std::lround(x)) + dx);
    EXPECT_GE(nearby, 3);
    EXPECT_EQ(shown.event_preview.width(), 120) << "of the sensor, whatever the frame's size";
}

TEST(Undistortion, CameraInfoTellsACameraWithoutDistortion) {
    const Calibration flat = undistorted(rational());
    EXPECT_EQ(flat.distortion_model, "plumb_bob");
    EXPECT_THAT(flat.d, testing::Each(0.0));
    EXPECT_THAT(flat.k, testing::ElementsAre(70, 0, 58, 0, 70, 45, 0, 0, 1));
    EXPECT_THAT(flat.r, testing::ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 1));
    EXPECT_EQ(flat.p, rational().p) << "with the base line";
}

TEST(Undistortion, MakesItsMapsOnceAndAllocatesNothingAfter) {
    if (!test::can_count_allocations()) GTEST_SKIP() << "a sanitizer's malloc";
    Frame frame = taken(barrel());
    frame.event_preview = Array2<float>{90, 120};
    for (Array2<float>& plane : frame.colour) plane = frame.intensity;
    Undistortion undistortion{plan_undistortion(barrel(), 120, 90, {})};
    undistortion.apply(frame);
    test::AllocationCount count;
    for (int i = 0; i < 10; ++i) undistortion.apply(frame);
    EXPECT_EQ(count.stop(), 0);
}

/// Linear weights keep a straight plane; cubic ones of a = -3/4 at the pixels, and nearly between.
TEST(ResamplingMap, TakesPlanesAtOtherPlaces) {
    Array2<float> from{30, 40};
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) from(y, x) = float(2 * x - 3 * y);
    const std::vector<std::pair<float, float>> wanted{
        {5, 7},    {5.5F, 7.25F}, {38.75F, 28}, {0, 0},     {39, 29},  {-.5F, 3},
        {-.6F, 3}, {39.6F, 3},    {39.4F, 3},   {37.5F, 9}, {38.5F, 9}};
    SourcePlaces places{Array2<float>{1, 11}, Array2<float>{1, 11}};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        places.x(0, int(i)) = wanted[i].first;
        places.y(0, int(i)) = wanted[i].second;
    }
    const ResamplingMap map{places, {0, 0, 40, 30}};
    Array2<float> to;
    for (const Resampling how : {Resampling::linear, Resampling::cubic}) {
        map.apply(from, to, how, -99);
        EXPECT_NEAR(to(0, 0), 2 * 5 - 3 * 7, 1e-4);
        EXPECT_NEAR(to(0, 1), 2 * 5.5 - 3 * 7.25, how == Resampling::linear ? 1e-4 : .2);
        if (how == Resampling::linear) {
            EXPECT_NEAR(to(0, 2), 2 * 38.75 - 3 * 28, 1e-4);
        }
        EXPECT_NEAR(to(0, 3), 0, 1e-4);
        EXPECT_NEAR(to(0, 4), 2 * 39 - 3 * 29, 1e-4);
        EXPECT_EQ(to(0, 6), -99) << "more than half a pixel outside";
        EXPECT_EQ(to(0, 7), -99);
        EXPECT_NEAR(to(0, 8), 2 * 39 - 3 * 3, .3) << "the last pixel goes on";
        EXPECT_NEAR(to(0, 9), 2 * 37.5 - 3 * 9, .2) << "and nothing comes from the next row";
        EXPECT_NEAR(to(0, 10), 2 * 38.5 - 3 * 9, .2);
    }
    map.apply(from, to, Resampling::linear, -99);
    EXPECT_NEAR(to(0, 5), 2 * 0 - 3 * 3, 1e-4) << "the outer pixel goes on";
    map.apply(from, to, Resampling::nearest, -99);
    EXPECT_EQ(to(0, 2), 2 * 39 - 3 * 28);
    EXPECT_EQ(to(0, 1), 2 * 6 - 3 * 7);
    // Of a part of the frame the same.
    const ResamplingMap of_part{places, {2, 3, 20, 20}};
    Array2<float> part{20, 20}, cut;
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x) part(y, x) = from(3 + y, 2 + x);
    of_part.apply(part, cut, Resampling::cubic, -99);
    map.apply(from, to, Resampling::cubic, -99);
    EXPECT_EQ(cut(0, 1), to(0, 1));
    EXPECT_EQ(cut(0, 3), -99);
}

#ifdef EVENTIDE_CALIB3D
TEST(SourcePlaces, AreThoseOfOpenCv) {
    for (const Calibration& c : {barrel(), rational(), fisheye()}) {
        const SourcePlaces places = source_places(c, {0, 0, 120, 90});
        const cv::Mat k(3, 3, CV_64F, const_cast<double*>(c.k.data())),
            r(3, 3, CV_64F, const_cast<double*>(c.r.data())),
            p(3, 4, CV_64F, const_cast<double*>(c.p.data()));
        const cv::Mat d(c.d, true);
        cv::Mat x, y;
        if (c.distortion_model == "equidistant")
            cv::fisheye::initUndistortRectifyMap(k, d, r, p.colRange(0, 3).clone(), {120, 90},
                                                 CV_32FC1, x, y);
        else
            cv::initUndistortRectifyMap(k, d, r, p.colRange(0, 3).clone(), {120, 90}, CV_32FC1, x,
                                        y);
        for (int row = 0; row < 90; ++row)
            for (int column = 0; column < 120; ++column) {
                ASSERT_NEAR(places.x(row, column), x.at<float>(row, column), 2e-3)
                    << c.distortion_model << " " << column << "," << row;
                ASSERT_NEAR(places.y(row, column), y.at<float>(row, column), 2e-3);
            }
    }
}
#endif

}  // namespace
}  // namespace eventide
