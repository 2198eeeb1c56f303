// Filters that put events and images elsewhere.
#pragma once

#include "pipeline/filters/data_filter.h"

namespace eventide {

class FlipFilter final : public DataFilter {
public:
    /// `across`: left becomes right; else top becomes bottom.
    FlipFilter(const SensorPixels& size, bool across) : size_(size), across_(across) {}
    void process(Batch& batch) override;
    SensorPixels size() const override { return size_; }
    ColourFilter pattern(ColourFilter before) const override;

private:
    SensorPixels size_;
    bool across_;
};

class TransposeFilter final : public DataFilter {
public:
    explicit TransposeFilter(const SensorPixels& size) : size_{size.height, size.width} {}
    void process(Batch& batch) override;
    SensorPixels size() const override { return size_; }
    ColourFilter pattern(ColourFilter before) const override;

private:
    SensorPixels size_;
};

/// Keeps what lies at multiples of two numbers, of images, too, and divides by them.
class ThinningFilter final : public DataFilter {
public:
    ThinningFilter(const SensorPixels& size, int columns, int rows)
        : size_{(size.width + columns - 1) / columns, (size.height + rows - 1) / rows},
          columns_(columns),
          rows_(rows) {}
    void process(Batch& batch) override;
    SensorPixels size() const override { return size_; }
    ColourFilter pattern(ColourFilter before) const override;

private:
    SensorPixels size_;
    int columns_, rows_;
};

}  // namespace eventide
