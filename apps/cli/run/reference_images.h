// The sensor's own images of the last moments, kept for whoever shows the truth beside a frame.
#pragma once

#include "pipeline/sinks/contact_sheet.h"
#include "pipeline/stages.h"
#include "src/core/frame_data.h"

#include <opencv2/core.hpp>

#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>

namespace eventide::app {

/// Thread: any; see() is called on the bin thread, draw() on the render thread.
class ReferenceImages : public DataObserver {
public:
    enum class Shows { grey, colours };  ///< of images that have some

    /// Longer than the contact sheet waits and event windows lie between the two threads, however
    /// many images that is; but no more memory than that for images beyond the first few.
    static constexpr SensorDuration kKept = 4 * kTruthDelay;
    static constexpr std::size_t kKeptAnyway = 64, kMostBytes = std::size_t{1} << 29;

    void see(const Batch& batch) override;

    /// The image taken nearest to a frame's time, no further than half its event window away, on
    /// black where it does not cover the sensor (CV_8UC1); leaves `shown` empty where there is
    /// none.
    void draw(SensorTime t, const Window& window, cv::Size sensor, cv::Mat& shown) const;
    /// The same for looking at beside the frame: also where it is as near as half the time between
    /// images;
    /// CV_8UC3 where it has colours that are asked for.
    void draw_nearest(SensorTime t, const Window& window, cv::Size sensor, Shows shows,
                      cv::Mat& shown) const;

private:
    /// Empty where there is none.
    std::optional<std::size_t> nearest_to(SensorTime t) const;
    void draw(const ReferenceImage& image, cv::Size sensor, Shows shows, cv::Mat& shown) const;
    /// Between it and the nearer of its neighbours; 0 where it has none.
    SensorDuration spacing_at(std::size_t image) const;

    bool is_one_too_many() const;

    mutable std::mutex mutex_;
    std::deque<ReferenceImage> images_;
    std::size_t bytes_ = 0;  // of their pixels
};

}  // namespace eventide::app
