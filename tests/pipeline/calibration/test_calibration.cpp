// Calibration files of ROS and Kalibr as CameraInfo, for frames of any size, part and side.
#include "pipeline/calibration/calibration.h"
#include "src/core/error.h"
#include "tests/system/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <tuple>

namespace eventide {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kRos = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo/left
camera_matrix:
  rows: 3
  cols: 3
  data: [500.5, 0.0, 320.25, 0.0, 501.5, 240.75, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.25, 0.0625, 0.001, -0.002, 0.0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
projection_matrix:
  rows: 3
  cols: 4
  data: [490.0, 0.0, 319.0, -49.0, 0.0, 490.0, 239.0, 0.0, 0.0, 0.0, 1.0, 0.0]
)";

constexpr const char* kKalibr = R"(cam0:
  camera_model: pinhole
  distortion_coeffs: [0.01, -0.02, 0.003, 0.004]
  distortion_model: equidistant
  intrinsics: [200.0, 201.0, 172.5, 129.5]
  resolution: [346, 260]
  rostopic: /dvs/image_raw
cam1:
  camera_model: pinhole
  distortion_coeffs: [-0.3, 0.1, 0.001, 0.002]
  distortion_model: radtan
  intrinsics: [300.0, 301.0, 160.0, 120.0]
  resolution: [320, 240]
)";

class CalibrationFile : public testing::Test {
protected:
    Calibration read(const std::string& text, const std::string& camera = {}) {
        test::write_text(temp_ / "camera.yaml", text);
        return read_calibration(temp_ / "camera.yaml", camera);
    }
    std::string error_of(const std::string& text, const std::string& camera = {}) {
        try {
            read(text, camera);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            return error.what();
        }
        ADD_FAILURE() << "nothing was thrown";
        return {};
    }
    static std::string with(std::string text, const std::string& old, const std::string& now) {
        text.replace(text.find(old), old.size(), now);
        return text;
    }

    test::TempFolder temp_;
};

TEST_F(CalibrationFile, OfRosIsTakenAsItIs) {
    const Calibration c = read(kRos);
    EXPECT_EQ(c.width, 640);
    EXPECT_EQ(c.height, 480);
    EXPECT_EQ(c.distortion_model, "plumb_bob");
    EXPECT_THAT(c.d, ElementsAre(-0.25, 0.0625, 0.001, -0.002, 0.0));
    EXPECT_THAT(c.k, ElementsAre(500.5, 0, 320.25, 0, 501.5, 240.75, 0, 0, 1));
    EXPECT_THAT(c.p, ElementsAre(490, 0, 319, -49, 0, 490, 239, 0, 0, 0, 1, 0));
}

TEST_F(CalibrationFile, OfKalibrIsTranslated) {
    const Calibration first = read(kKalibr);
    EXPECT_EQ(first.width, 346);
    EXPECT_EQ(first.distortion_model, "equidistant");
    EXPECT_THAT(first.d, ElementsAre(0.01, -0.02, 0.003, 0.004));
    EXPECT_THAT(first.k, ElementsAre(200, 0, 172.5, 0, 201, 129.5, 0, 0, 1));
    EXPECT_THAT(first.p, ElementsAre(200, 0, 172.5, 0, 0, 201, 129.5, 0, 0, 0, 1, 0));
    EXPECT_THAT(first.r, ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 1));
    const Calibration second = read(kKalibr, "cam1");
    EXPECT_EQ(second.distortion_model, "plumb_bob");
    EXPECT_THAT(second.d, ElementsAre(-0.3, 0.1, 0.001, 0.002, 0.0)) << "k1 k2 p1 p2 k3";
}

TEST_F(CalibrationFile, SaysWhereItIsWrong) {
    EXPECT_THAT(error_of("image_width: [1\n"), HasSubstr("camera.yaml:"));
    EXPECT_THAT(error_of(""), HasSubstr("found nothing"));
    EXPECT_THAT(error_of("a: 1\n"),
                HasSubstr("image_width (ROS) or cam0 with intrinsics (Kalibr)"));
    EXPECT_THAT(error_of(with(kRos, "640", "wide")),
                HasSubstr("camera.yaml:1: image_width: expected a number, found 'wide'"));
    EXPECT_THAT(error_of(with(kRos, "500.5, ", "")), HasSubstr("expected 9 numbers, found 8"));
    EXPECT_THAT(error_of(with(kRos, "plumb_bob", "fov")), HasSubstr("found 'fov'"));
    EXPECT_THAT(error_of(with(kRos, "-0.25, ", "")),
                HasSubstr("expected 5 numbers for plumb_bob, found 4"));
    EXPECT_THAT(error_of(with(kRos, "500.5", ".nan")), HasSubstr("expected a number"));
    EXPECT_THAT(error_of(with(kKalibr, "pinhole", "omni")), HasSubstr("found 'omni'"));
    EXPECT_THAT(error_of(kKalibr, "cam2"), HasSubstr("expected a cam2, found none"));
    EXPECT_THAT(error_of(with(kKalibr, "[346", "[346.5")),
                HasSubstr("resolution: expected 1 to 16384, found 346.5"));
    EXPECT_THAT(error_of(with(kKalibr, "[346", "[1e300")), HasSubstr("found 1e+300"));
    EXPECT_LT(error_of(with(kRos, "640", std::string(1 << 20, 'x'))).size(), 400U);
    EXPECT_THAT(error_of("a: &a [*a, *a]\nimage_width: 3\n"), HasSubstr("expected"));
}

TEST_F(CalibrationFile, OfACameraThatIsNotCalibratedIsRefused) {
    for (const auto& [text, old, now] : {std::tuple{kRos, "500.5, 0.0", "0.0, 0.0"},
                                         {kRos, "0.0, 501.5", "0.0, 0.0"},
                                         {kRos, "490.0, 0.0, 319", "0.0, 0.0, 319"},
                                         {kRos, "490.0, 239", "-490.0, 239"},
                                         {kKalibr, "200.0, 201.0", "0, 201.0"},
                                         {kKalibr, "200.0, 201.0", "200.0, 0"}})
        EXPECT_THAT(error_of(with(text, old, now)), HasSubstr("expected focal lengths above 0"))
            << now;
    EXPECT_THAT(error_of(with(kRos, "500.5, 0.0", "0.0, 0.0")), HasSubstr("found 0 and 501.5"));
}

/// Where a point of the scene falls, by the usual equations of the two models.
struct Pixel {
    double x, y;
};
Pixel project(const Calibration& c, double x, double y) {
    const double r2 = x * x + y * y;
    const double radial = 1 + c.d[0] * r2 + c.d[1] * r2 * r2;
    const double u = x * radial + 2 * c.d[2] * x * y + c.d[3] * (r2 + 2 * x * x);
    const double v = y * radial + c.d[2] * (r2 + 2 * y * y) + 2 * c.d[3] * x * y;
    return {c.k[0] * u + c.k[1] * v + c.k[2], c.k[4] * v + c.k[5]};
}

TEST_F(CalibrationFile, IsFittedToSizePartAndSide) {
    const Calibration sensor = read(kRos);
    // Twice as large; of that x 100 to 899 and y 50 to 649; then mirrored.
    for (const Flip flip : {Flip::none, Flip::horizontal, Flip::vertical, Flip::both}) {
        const Calibration image = fitted(sensor, {1280, 960, 100, 50, flip}, 800, 600);
        EXPECT_EQ(image.width, 800);
        const bool mirrored_x = flip == Flip::horizontal || flip == Flip::both;
        const bool mirrored_y = flip == Flip::vertical || flip == Flip::both;
        for (const auto& [x, y] : {Pixel{0, 0}, Pixel{0.3, -0.2}, Pixel{-0.4, 0.1}}) {
            const Pixel before = project(sensor, x, y);
            Pixel expected{before.x * 1279 / 639 - 100, before.y * 959 / 479 - 50};
            if (mirrored_x) expected.x = 799 - expected.x;
            if (mirrored_y) expected.y = 599 - expected.y;
            const Pixel found = project(image, mirrored_x ? -x : x, mirrored_y ? -y : y);
            EXPECT_NEAR(found.x, expected.x, 1e-9) << name_of(flip);
            EXPECT_NEAR(found.y, expected.y, 1e-9) << name_of(flip);
        }
        EXPECT_NEAR(image.p[3], (mirrored_x ? 49 : -49) * 1279. / 639, 1e-9);
    }
    EXPECT_THAT(fitted(sensor, {}, 640, 480).k, sensor.k) << "as it was";
    const Calibration none = fitted({}, {}, 64, 48);
    EXPECT_EQ(none.width, 64);
    EXPECT_EQ(none.k[0], 0) << "not calibrated";
}

/// Where a point of the scene falls in the rectified image: P R X.
Pixel rectified(const Calibration& c, const std::array<double, 3>& point) {
    std::array<double, 3> turned{}, shown{c.p[3], c.p[7], c.p[11]};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) turned[i] += c.r[3 * i + j] * point[j];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) shown[i] += c.p[4 * i + j] * turned[j];
    return {shown[0] / shown[2], shown[1] / shown[2]};
}

TEST_F(CalibrationFile, OfAMirroredFrameIsRectifiedToTheMirroredImage) {
    Calibration sensor = read(kRos);
    const double a = .2, b = .1;  // about two axes
    sensor.r = {std::cos(a),
                std::sin(a) * std::sin(b),
                std::sin(a) * std::cos(b),
                0,
                std::cos(b),
                -std::sin(b),
                -std::sin(a),
                std::cos(a) * std::sin(b),
                std::cos(a) * std::cos(b)};
    sensor.p = {490, 3, 319, -49, 0, 495, 239, 21, 0, 0, 1, 0};
    for (const Flip flip : {Flip::none, Flip::horizontal, Flip::vertical, Flip::both}) {
        const Calibration image = fitted(sensor, {640, 480, 0, 0, flip}, 640, 480);
        const bool mirrored_x = flip == Flip::horizontal || flip == Flip::both;
        const bool mirrored_y = flip == Flip::vertical || flip == Flip::both;
        for (const auto& [x, y] : {Pixel{0, 0}, Pixel{.3, -.2}, Pixel{-.4, .1}}) {
            const Pixel before = rectified(sensor, {x, y, 1});
            const Pixel found = rectified(image, {mirrored_x ? -x : x, mirrored_y ? -y : y, 1});
            EXPECT_NEAR(found.x, mirrored_x ? 639 - before.x : before.x, 1e-9) << name_of(flip);
            EXPECT_NEAR(found.y, mirrored_y ? 479 - before.y : before.y, 1e-9) << name_of(flip);
        }
    }
}

TEST_F(CalibrationFile, OfAFisheyeLensLooksTheSameInAMirror) {
    const Calibration sensor = read(kKalibr);
    EXPECT_EQ(fitted(sensor, {346, 260, 0, 0, Flip::both}, 346, 260).d, sensor.d);
}

}  // namespace
}  // namespace eventide
