// Filters that remember what each pixel did.
#pragma once

#include "pipeline/filters/data_filter.h"
#include "pipeline/filters/hot_pixels.h"

#include <optional>
#include <utility>
#include <vector>

namespace eventide {

/// Whether `last`, which may be none (SensorTime::min()), lies in [t - within, t]; a time after t
/// is from before the clock went back.
inline bool is_recent(SensorTime last, SensorTime t, SensorDuration within) {
    return last != SensorTime::min() && last <= t && t - last <= within;
}

/// A time for each pixel; none after the clock went back.
class TimesOfPixels {
public:
    explicit TimesOfPixels(const SensorPixels& size)
        : width_(size.width),
          height_(size.height),
          times_(std::size_t(size.width) * std::size_t(size.height), SensorTime::min()) {}
    /// Whether the pixel's time lies in [t - within, t].
    bool is_recent(int x, int y, SensorTime t, SensorDuration within) const;
    void set(int x, int y, SensorTime t);
    int width() const { return width_; }
    int height() const { return height_; }

private:
    int width_, height_;
    std::vector<SensorTime> times_;  // [y][x]
};

class RefractoryFilter final : public DataFilter {
public:
    RefractoryFilter(const SensorPixels& size, SensorDuration time)
        : size_(size), time_(time), last_(size) {}
    void process(Batch& batch) override;
    SensorPixels size() const override { return size_; }

private:
    SensorPixels size_;
    SensorDuration time_;
    TimesOfPixels last_;  // that stayed
};

/// Events that are left out support others all the same.
class BackgroundActivityFilter final : public DataFilter {
public:
    static constexpr int kLargestRadius = 8;  // px

    BackgroundActivityFilter(const SensorPixels& size, SensorDuration time, int radius, int support)
        : size_(size), time_(time), radius_(radius), support_(support), newest_(size) {}
    void process(Batch& batch) override;
    SensorPixels size() const override { return size_; }

private:
    bool is_supported(const Event& event) const;
    SensorPixels size_;
    SensorDuration time_;
    int radius_, support_;
    TimesOfPixels newest_;
};

class HotPixelDataFilter final : public DataFilter {
public:
    HotPixelDataFilter(const SensorPixels& size, HotPixelFilter filter)
        : size_(size), filter_(std::move(filter)) {}
    void process(Batch& batch) override { filter_.process(batch.events); }
    SensorPixels size() const override { return size_; }

private:
    SensorPixels size_;
    HotPixelFilter filter_;
};

}  // namespace eventide
