// The pipeline's rows of `eventide bench`: as a table, as JSON with the stages, and as a plot.
#pragma once

#include "apps/bench/activity.h"
#include "apps/bench/peaks.h"
#include "apps/bench/stages.h"
#include "apps/evaluate/plot.h"
#include "src/settings/values.h"

#include <cstdio>
#include <string>
#include <vector>

namespace eventide::app {

/// One line of the table.
struct BenchRow {
    std::string model, engine;
    Size sensor;
    double event_rate = 0;       ///< per second of sensor time
    double encode_ms = 0;        ///< per event window, median
    double render_ms = 0;        ///< per frame, median
    double times_real_time = 0;  ///< sensor time over host time, everything included
    double latency_p50_ms = 0, latency_p99_ms = 0;  ///< at the pace of the camera
    /// Against the truth at the frames' times; NaN where frames are of another size than it.
    double mse = 0;
};

void print_bench_table(const std::vector<BenchRow>& rows, std::FILE* to);

/// All that was measured, and on which machine; ends with a line feed.
std::string bench_json(const std::vector<bench::StageRow>& stages,
                       const std::vector<bench::ActivityRow>& activity, const bench::Peaks& peaks,
                       const std::vector<BenchRow>& rows);

/// Error over work, one line per sensor size.
Plot bench_plot(const std::vector<BenchRow>& rows);

}  // namespace eventide::app
