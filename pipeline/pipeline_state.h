// What stands between parser and network, as it was at one moment of a recording.
#pragma once

#include "src/binning/slicer.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace eventide {

/// Once all events up to `t` have come and none after it. With the encoder's state and the filter's
/// at that moment, another run goes on where this one was.
struct PipelineState {
    SensorTime t{};
    Slicer::State slicer;
    std::vector<std::uint8_t> ages;  ///< Binner::ages()
};

/// Moments at which somebody keeps it.
struct StateStops {
    std::vector<SensorTime> times;  ///< ascending
    /// Every event window up to there has been encoded. May throw.
    std::function<void(const PipelineState&)> keep;
};

}  // namespace eventide
