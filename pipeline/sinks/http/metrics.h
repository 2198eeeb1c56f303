// Counters of a run as Prometheus reads them.
#pragma once

#include "pipeline/counters.h"

#include <cstdint>
#include <string>

namespace eventide {

/// What the page itself counts.
struct HttpCounters {
    std::uint64_t viewers = 0, listeners = 0;  ///< now: of images, of statistics
    std::uint64_t requests = 0, refused = 0;   ///< since the start
    std::uint64_t copied = 0;                  ///< frames, for viewers, since the start
};

/// The text format 0.0.4. Names end in units; totals only grow.
std::string metrics_text(const Snapshot& now, const HttpCounters& http);

}  // namespace eventide
