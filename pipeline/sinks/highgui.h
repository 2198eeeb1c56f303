// OpenCV's windows. Their library brings Qt and is loaded when a window is asked for.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/highgui.hpp>

namespace eventide {

struct HighGui {
    decltype(cv::namedWindow)* named_window;
    void (*resize_window)(const cv::String& name, int width, int height);
    void (*show)(const cv::String& name, cv::InputArray image);
    decltype(cv::waitKey)* wait_key;
    decltype(cv::getWindowProperty)* window_property;
    decltype(cv::destroyWindow)* destroy_window;
};

/// Throws Error (failed) where the library cannot be loaded. Thread: any; windows are for one.
const HighGui& highgui();

}  // namespace eventide
