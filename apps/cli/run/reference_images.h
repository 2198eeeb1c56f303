// The sensor's own images of the last moments, kept for whoever shows the truth beside a frame.
#pragma once

#include "pipeline/stages.h"
#include "src/core/frame_data.h"

#include <opencv2/core.hpp>

#include <deque>
#include <mutex>

namespace eventide::app {

/// Thread: any; see() is called on the bin thread, draw() on the render thread.
class ReferenceImages : public DataObserver {
public:
    /// More than can lie between the two threads.
    static constexpr std::size_t kKept = 64;

    void see(const Batch& batch) override;

    /// The image taken nearest to the frame's time, no further than half its window away, on black
    /// where it does not cover the sensor (CV_8UC1); leaves `image` empty where there is none.
    void draw(const Frame& frame, int sensor_width, int sensor_height, cv::Mat& shown) const;

private:
    mutable std::mutex mutex_;
    std::deque<ReferenceImage> images_;
};

}  // namespace eventide::app
