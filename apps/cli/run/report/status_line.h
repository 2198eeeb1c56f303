// The moving line of a run.
#pragma once

#include "apps/cli/run/report/run_report.h"

#include <cstddef>
#include <string>

namespace eventide::app {

/// "[====>  ]  43 %  1.8x real time  1:23 left  1.2 M events/s  frames 120  lost 0 ...", in at most
/// `columns`. From 40 columns on it keeps the share done, times real time, the time left (of a
/// recording), the latency (of a live source), and what was lost, skipped and damaged.
std::string status_line(const Snapshot& now, const RunProgress& progress, std::size_t columns);

/// How much of what was asked for has been done, from 0 to 1; 0 where nobody can tell.
double share_done(const Snapshot& now, const RunProgress& progress);

}  // namespace eventide::app
