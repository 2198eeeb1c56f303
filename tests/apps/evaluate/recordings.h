// Small recordings with reference images, made for evaluations.
#pragma once

#include "tests/metrics/images.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <opencv2/imgcodecs.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace eventide::test {

namespace fs = std::filesystem;

inline constexpr int kWidth = 36, kHeight = 28;

inline void write_image(const fs::path& path, const Array2<float>& image) {
    cv::Mat out(image.height(), image.width(), CV_8U);
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            out.at<std::uint8_t>(y, x) = std::uint8_t(std::lround(255 * image(y, x)));
    cv::imwrite(path.string(), out);
}

/// A fresh folder of this name, of this process alone: tests run beside each other.
inline fs::path fresh_folder(const std::string& name) {
    const fs::path own = fs::path{testing::TempDir()} / std::to_string(::getpid());
    const fs::path folder = own / ("eventide_" + name);
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

/// A recording in the manner of the Event Camera Dataset: an event each `step_s`, an image each
/// `image_s`, for `span_s`.
inline fs::path write_recording(const fs::path& folder, double span_s, double step_s,
                                double image_s) {
    fs::create_directories(folder / "images");
    std::ofstream events{folder / "events.txt"}, images{folder / "images.txt"};
    events << std::fixed;
    images << std::fixed;
    for (int i = 0; i * step_s < span_s; ++i)
        events << i * step_s << ' ' << i * 7 % kWidth << ' ' << i * 5 % kHeight << ' ' << i % 2
               << '\n';
    for (int i = 0; i * image_s < span_s; ++i) {
        const std::string name = "images/frame_" + std::to_string(100 + i) + ".png";
        images << i * image_s << ' ' << name << '\n';
        write_image(folder / name, test_image(kHeight, kWidth, 1 + i % 3));
    }
    return folder;
}

}  // namespace eventide::test
