// What the processor can do at most, beside a benchmark's figures.
#pragma once

#include "apps/bench/stage_table.h"

#include <benchmark/benchmark.h>

namespace eventide::bench {

/// Measured now, shown over the table.
inline void add_peaks(Instructions most) {
    benchmark::AddCustomContext("peak", peaks_text(measure_peaks(most)));
}

}  // namespace eventide::bench
