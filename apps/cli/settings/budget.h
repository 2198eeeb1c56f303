// --budget: what the network may take of the processor.
#pragma once

#include "src/core/sensor_time.h"

#include <optional>
#include <string>

namespace eventide::app {

/// At most one of the two; none: as much as holds the pace.
struct Budget {
    std::optional<SensorDuration> per_frame;  ///< processor time for each frame asked for
    std::optional<double> share;              ///< of a core; 2 is two of them

    bool is_set() const { return per_frame || share; }
    /// In cores, at so many frames asked for in a second; empty: no budget.
    std::optional<double> cores(double frames_per_second) const;
};

/// "8ms", "50%" (of a core, to 100000%) or "none". Throws Error (usage).
Budget parse_budget(const std::string& text);
std::string show_budget(const Budget& budget);

}  // namespace eventide::app
