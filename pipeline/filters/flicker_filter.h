// Leaves out the events of pixels that see a lamp or a screen flicker.
#pragma once

#include "pipeline/filters/data_filter.h"

#include <vector>

namespace eventide {

/// A pixel flickers while its brightness begins to rise (an on event after an off event, or its
/// first) at equal intervals within the band: from the third interval on that agrees with those
/// before it, within 3 / 20 of a cycle, until intervals have disagreed or stayed away. Now and then
/// an interval may be twice as long, where a cycle was too faint; one with a rise within is no
/// cycle. All events of a pixel that flickers are left out; what moves across it is seen again
/// after two rises that come at other times.
class FlickerFilter final : public DataFilter {
public:
    static constexpr int kLowestHz = 1, kHighestHz = 10'000;
    static constexpr int kIntervals = 3;  ///< that agree, before a pixel is taken to flicker
    static constexpr int kCycles = 2;     ///< in an interval at most

    /// What flickers at low_hz to high_hz, kLowestHz <= low_hz < high_hz <= kHighestHz.
    FlickerFilter(const SensorPixels& size, int low_hz, int high_hz);

    void process(Batch& batch) override;
    SensorPixels size() const override { return size_; }

private:
    struct Pixel {
        SensorTime rise = SensorTime::min();  // none
        SensorDuration cycle{};
        std::uint8_t agreed = 0;  // so many intervals
        bool was_on = false;
        bool rose_again = false;  // too soon for a cycle
    };
    bool flickers(const Event& event);
    void learn(Pixel& pixel, SensorDuration interval) const;

    SensorPixels size_;
    SensorDuration shortest_, longest_;  // of a cycle
    std::vector<Pixel> pixels_;          // [y][x]
};

}  // namespace eventide
