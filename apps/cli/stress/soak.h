// Hours of stream time at full speed, with pauses and bursts: what grows, and what does not.
#pragma once

#include "apps/cli/stress/stress_case.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace eventide::stress {

/// At the end of one of a hundred parts of the run.
struct SoakSample {
    double stream_hours = 0, host_seconds = 0;
    std::uint64_t events = 0, windows = 0;  ///< since the beginning
    double resident_mib = 0;
    double latency_p50_ms = 0, latency_p99_ms = 0;  ///< of the frames of this part
    double largest_state = 0, rms_state = 0;        ///< recurrent levels
};

struct SoakSettings {
    double hours = 24;
    int width = 32, height = 24;  ///< px
    /// Sees each sample as it is taken. Caller's thread.
    std::function<void(const SoakSample&)> on_sample;
    std::function<bool()> stopping;
};

std::vector<SoakSample> soak(const Model& model, const EngineOptions& engine,
                             const SoakSettings& settings);

/// After the first minute: resident memory within 1 %; latency of the last quarter's frames (the
/// median of its parts) at most twice that of the first quarter's, because other work of the
/// machine comes and goes; states within 1.
Result soak_verdict(const std::vector<SoakSample>& samples);

}  // namespace eventide::stress
