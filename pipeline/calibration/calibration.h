// What a calibrated camera is: sensor_msgs/CameraInfo out of a file of ROS or Kalibr.
#pragma once

#include "pipeline/sinks/adjust.h"

#include <eventide/frame.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

/// The fields of sensor_msgs/CameraInfo, in its notation.
struct Calibration {
    int width = 0, height = 0;     ///< px, of the images it is for
    std::string distortion_model;  ///< "plumb_bob", "rational_polynomial", "equidistant"; empty:
                                   ///< not calibrated, and all below is zero
    std::vector<double> d;
    std::array<double, 9> k{}, r{};  ///< 3x3, row by row
    std::array<double, 12> p{};      ///< 3x4, row by row
};

/// Reads what camera_calibration writes (image_width, camera_matrix, ...) and Kalibr's camchain
/// (cam0: intrinsics, distortion_coeffs, ...; pinhole with radtan, equidistant or none). `camera`
/// names one of Kalibr's cameras; empty: the first. Throws Error (input) with file and line.
Calibration read_calibration(const std::filesystem::path& file, const std::string& camera);

/// How the images that are sent come out of those of the whole sensor, in this order.
struct ImageGeometry {
    int width = 0, height = 0;  ///< px, of the whole frame that is rendered; 0: as it is sent
    int left = 0, top = 0;      ///< px, of the part that is rendered, and what is cropped from it
    Flip flip = Flip::none;
};

/// The calibration of images of width x height px that were made by `geometry` from what
/// `calibration` is for. Mirrored ones are those of a camera in a mirrored world.
Calibration fitted(const Calibration& calibration, const ImageGeometry& geometry, int width,
                   int height);

}  // namespace eventide
