// What a calibrated camera is.
#include "pipeline/calibration/calibration.h"

#include "pipeline/calibration/yaml_file.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/text_piece.h"

#include <cmath>
#include <cstdio>

namespace eventide {

namespace {

constexpr int kMaxPixels = kLargestFrameSide;

/// A node of the file, which knows what to say when it is not what it should be.
class Reader {
public:
    Reader(const std::filesystem::path& file, const YamlNode& node, std::string name)
        : file_{file}, node_{node}, name_{std::move(name)} {}

    [[noreturn]] void refuse(const std::string& expected, const std::string& found) const {
        throw Error(ErrorKind::input, file_.string() + ":" + std::to_string(node_.line) + ": " +
                                          name_ + ": expected " + expected + ", found " + found);
    }

    bool has(const char* key) const { return node_.find(key) != nullptr; }

    Reader at(const char* key) const {
        const YamlNode* node = node_.find(key);
        if (node == nullptr) refuse(std::string{"a "} + key, "none");
        return {file_, *node, key};
    }

    const std::string& text() const {
        if (node_.kind != YamlNode::Kind::scalar) refuse("one value", "a list or map");
        return node_.text;
    }

    double number() const {
        const auto value = number_in<double>(text());
        if (!value) refuse("a number", "'" + piece_of(text()) + "'");
        return *value;
    }

    int pixels() const { return pixels(number()); }
    int pixels(double value) const {
        if (value >= 1 && value <= kMaxPixels && value == std::floor(value)) return int(value);
        char found[32];
        std::snprintf(found, sizeof found, "%g", value);
        refuse("1 to " + std::to_string(kMaxPixels), found);
    }

    std::vector<double> numbers() const {
        if (node_.kind != YamlNode::Kind::list) refuse("a list of numbers", "none");
        std::vector<double> values;
        for (const YamlNode& item : node_.items)
            values.push_back(Reader{file_, item, name_}.number());
        return values;
    }

    template <std::size_t kSize>
    std::array<double, kSize> numbers_of() const {
        const std::vector<double> values = numbers();
        if (values.size() != kSize)
            refuse(std::to_string(kSize) + " numbers", std::to_string(values.size()));
        std::array<double, kSize> array{};
        std::copy(values.begin(), values.end(), array.begin());
        return array;
    }

private:
    const std::filesystem::path& file_;
    const YamlNode& node_;
    std::string name_;
};

constexpr std::array<double, 9> kNoRotation{1, 0, 0, 0, 1, 0, 0, 0, 1};

std::array<double, 12> projection_of(const std::array<double, 9>& k) {
    return {k[0], k[1], k[2], 0, k[3], k[4], k[5], 0, k[6], k[7], k[8], 0};
}

/// ROS demands five numbers of plumb_bob, four of equidistant, eight of rational_polynomial.
void check_distortion(const Reader& reader, const Calibration& calibration) {
    const auto need = [&](std::size_t n) {
        if (calibration.d.size() != n)
            reader.refuse(std::to_string(n) + " numbers for " + calibration.distortion_model,
                          std::to_string(calibration.d.size()));
    };
    if (calibration.distortion_model == "plumb_bob") return need(5);
    if (calibration.distortion_model == "equidistant") return need(4);
    if (calibration.distortion_model == "rational_polynomial") return need(8);
    reader.refuse("plumb_bob, equidistant or rational_polynomial",
                  "'" + piece_of(calibration.distortion_model) + "'");
}

/// ROS writes zeros for a camera that is not calibrated: frames would be black.
void check_focal_lengths(const Reader& reader, double fx, double fy) {
    if (fx > 0 && fy > 0) return;
    char found[64];
    std::snprintf(found, sizeof found, "%g and %g", fx, fy);
    reader.refuse("focal lengths above 0 px, as of a camera that is calibrated", found);
}

Calibration read_ros(const Reader& file) {
    Calibration calibration;
    calibration.width = file.at("image_width").pixels();
    calibration.height = file.at("image_height").pixels();
    calibration.distortion_model = file.at("distortion_model").text();
    const Reader d = file.at("distortion_coefficients").at("data");
    calibration.d = d.numbers();
    check_distortion(d, calibration);
    const Reader k = file.at("camera_matrix").at("data");
    calibration.k = k.numbers_of<9>();
    check_focal_lengths(k, calibration.k[0], calibration.k[4]);
    calibration.r = kNoRotation;
    if (file.has("rectification_matrix"))
        calibration.r = file.at("rectification_matrix").at("data").numbers_of<9>();
    calibration.p = projection_of(calibration.k);
    if (file.has("projection_matrix")) {
        const Reader p = file.at("projection_matrix").at("data");
        calibration.p = p.numbers_of<12>();
        check_focal_lengths(p, calibration.p[0], calibration.p[5]);
    }
    return calibration;
}

Calibration read_kalibr(const Reader& camera) {
    if (camera.has("camera_model") && camera.at("camera_model").text() != "pinhole")
        camera.at("camera_model")
            .refuse("pinhole, which is all that CameraInfo can say",
                    "'" + camera.at("camera_model").text() + "'");
    Calibration calibration;
    const Reader resolution = camera.at("resolution");
    const auto [width, height] = resolution.numbers_of<2>();
    calibration.width = resolution.pixels(width);
    calibration.height = resolution.pixels(height);
    const Reader intrinsics = camera.at("intrinsics");
    const auto [fx, fy, cx, cy] = intrinsics.numbers_of<4>();
    check_focal_lengths(intrinsics, fx, fy);
    calibration.k = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
    calibration.r = kNoRotation;
    calibration.p = projection_of(calibration.k);
    const Reader model = camera.at("distortion_model");
    const bool none = model.text() == "none";
    const Reader coefficients = none ? model : camera.at("distortion_coeffs");
    calibration.d = none ? std::vector<double>(4, 0.0) : coefficients.numbers();
    if (model.text() == "radtan" || none) {
        calibration.distortion_model = "plumb_bob";  // k1 k2 p1 p2, and k3, which Kalibr lacks
        if (calibration.d.size() == 4) calibration.d.push_back(0);
    } else if (model.text() == "equidistant") {
        calibration.distortion_model = "equidistant";
    } else {
        model.refuse("radtan, equidistant or none", "'" + model.text() + "'");
    }
    check_distortion(coefficients, calibration);
    return calibration;
}

/// Pixels along one axis: `scale` of size, then `shift` off, then mirrored in an image of `size`.
struct Axis {
    double scale, shift;
    int size;
    bool mirrored;

    double focal(double f) const { return f * scale; }
    /// The middle of the first pixel is at 0.
    double centre(double c) const {
        const double moved = c * scale - shift;
        return mirrored ? size - 1 - moved : moved;
    }
    double sign() const { return mirrored ? -1 : 1; }
};

/// Corners of a frame lie on corners of the sensor (docs/model.md, "Renderer").
double scale_of(int sensor, int whole) {
    return sensor > 1 ? double(whole - 1) / (sensor - 1) : 1;
}

/// Tangential terms: p2 goes with x, p1 with y. Radial ones do not see a mirror.
void mirror_distortion(Calibration& calibration, const Axis& x, const Axis& y) {
    if (calibration.distortion_model == "equidistant" || calibration.d.size() < 4) return;
    calibration.d[2] *= y.sign();
    calibration.d[3] *= x.sign();
}

}  // namespace

Calibration read_calibration(const std::filesystem::path& path, const std::string& camera) {
    const YamlNode root = read_yaml(path);
    const Reader file{path, root, "calibration"};
    if (file.has("image_width")) {
        if (!camera.empty()) file.refuse("a Kalibr file with " + camera, "one camera of ROS");
        return read_ros(file);
    }
    if (!camera.empty()) return read_kalibr(file.at(camera.c_str()));
    for (std::size_t i = 0; i < root.keys.size(); ++i)
        if (root.items[i].find("intrinsics") != nullptr)
            return read_kalibr({path, root.items[i], root.keys[i]});
    file.refuse("image_width (ROS) or cam0 with intrinsics (Kalibr)", "neither");
}

Calibration fitted(const Calibration& from, const ImageGeometry& geometry, int width, int height) {
    Calibration to = from;
    to.width = width;
    to.height = height;
    if (from.distortion_model.empty()) return to;
    const int whole_width = geometry.width > 0 ? geometry.width : width;
    const int whole_height = geometry.height > 0 ? geometry.height : height;
    const Axis x{scale_of(from.width, whole_width), double(geometry.left), width,
                 geometry.flip == Flip::horizontal || geometry.flip == Flip::both};
    const Axis y{scale_of(from.height, whole_height), double(geometry.top), height,
                 geometry.flip == Flip::vertical || geometry.flip == Flip::both};
    mirror_distortion(to, x, y);
    const std::array<double, 3> sign{x.sign(), y.sign(), 1};
    to.k = {x.focal(from.k[0]),
            x.focal(from.k[1]) * sign[0] * sign[1],
            x.centre(from.k[2]),
            0,
            y.focal(from.k[4]),
            y.centre(from.k[5]),
            0,
            0,
            1};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) to.r[3 * i + j] = sign[i] * from.r[3 * i + j] * sign[j];
    to.p = {x.focal(from.p[0]),
            x.focal(from.p[1]) * sign[0] * sign[1],
            x.centre(from.p[2]),
            x.focal(from.p[3]) * sign[0],
            0,
            y.focal(from.p[5]),
            y.centre(from.p[6]),
            y.focal(from.p[7]) * sign[1],
            0,
            0,
            1,
            0};
    return to;
}

}  // namespace eventide
