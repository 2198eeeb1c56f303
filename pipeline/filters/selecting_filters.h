// Filters that look at one event at a time.
#pragma once

#include "pipeline/filters/data_filter.h"

#include <cstdint>
#include <optional>

namespace eventide {

class RegionFilter final : public DataFilter {
public:
    /// px; the part of it that lies on the sensor counts.
    RegionFilter(const SensorPixels& size, int x, int y, int width, int height)
        : size_(size), left_(x), top_(y), right_(x + width), bottom_(y + height) {}
    void process(Batch& batch) override;
    SensorPixels size() const override { return size_; }

private:
    SensorPixels size_;
    int left_, top_, right_, bottom_;
};

class PolarityFilter final : public DataFilter {
public:
    PolarityFilter(const SensorPixels& size, Polarity kept) : size_(size), kept_(kept) {}
    void process(Batch& batch) override;
    SensorPixels size() const override { return size_; }

private:
    SensorPixels size_;
    Polarity kept_;
};

class EveryNthFilter final : public DataFilter {
public:
    EveryNthFilter(const SensorPixels& size, std::uint64_t n) : size_(size), n_(n) {}
    void process(Batch& batch) override;
    SensorPixels size() const override { return size_; }

private:
    SensorPixels size_;
    std::uint64_t n_, seen_ = 0;
};

/// Also of images, IMU samples and triggers.
class TimeFilter final : public DataFilter {
public:
    struct TimePoint {
        bool absolute = false;  ///< else after the first event
        SensorDuration value{};
    };
    /// Both ends included; empty: open.
    TimeFilter(const SensorPixels& size, std::optional<TimePoint> from, std::optional<TimePoint> to)
        : size_(size), from_(from), to_(to) {}
    void process(Batch& batch) override;
    void count_from(SensorTime first) override { first_ = first; }
    SensorPixels size() const override { return size_; }

private:
    bool is_inside(SensorTime t) const;
    SensorPixels size_;
    std::optional<TimePoint> from_, to_;
    std::optional<SensorTime> first_;
};

}  // namespace eventide
