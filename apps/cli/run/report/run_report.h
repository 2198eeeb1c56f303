// The counters of a run as people and programs read them.
#pragma once

#include "apps/cli/run/quality/quality_report.h"
#include "pipeline/counters.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace eventide::app {

/// What is needed beside the counters themselves.
struct RunProgress {
    std::chrono::duration<double> elapsed{0};
    std::uint64_t total_bytes = 0;             ///< of a recording; 0 where not known
    std::optional<SensorTime> end{};           ///< where it is known: of what was asked for, ...
    std::optional<SensorDuration> duration{};  ///< ... or its length
    bool in_step = false;   ///< with the world: a camera, or a recording at a pace; latency counts
    double event_rate = 0;  ///< per second of host time, lately; final JSON says the mean
    std::optional<QualityState> quality{};
};

/// Three or four lines at the end.
std::string summary_text(const Snapshot& end, const RunProgress& progress);

/// Why a run gave no frame, for people; empty when it gave some.
std::string why_no_frames(const Snapshot& end);

/// "camera: dropped events 12, reconnects 1": what went wrong between it and this machine; empty
/// where nothing did. Of `brief` words: "camera drop 12 back 1".
std::string camera_text(const CameraCounters& camera, bool brief);

/// One JSON object in one line. docs/usage.md names the keys.
std::string stats_json(const Snapshot& now, const RunProgress& progress, bool final);

/// Data were lost or made no sense: what --strict asks.
bool lost_data(const Snapshot& end);

}  // namespace eventide::app
