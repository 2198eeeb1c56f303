// Stages as text and as JSON.
#pragma once

#include "apps/bench/activity.h"
#include "apps/bench/stages.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace eventide::bench {

/// "one core's peak, GFLOP/s: f32 110 (AVX2), ..."
std::string peaks_text(const Peaks& peaks);

/// The table's head and a line for each row, median with quartiles in processor time.
std::string stages_text(const std::vector<StageRow>& rows);

/// An array; each row with encode_ms, render_fresh_ms, render_again_ms, bin_mev_s, peak_f32_gflops,
/// peak_bf16_gflops and share (of encode, render_fresh, render_again), processor time, and beside
/// them quartiles and wall time.
nlohmann::ordered_json stages_json(const std::vector<StageRow>& rows, const Peaks& peaks);

/// Milliseconds of processor time, and beside them how many per cent of what a wholly moving scene
/// takes in the same table; the error of frames against those without skipping.
std::string activity_text(const std::vector<ActivityRow>& rows);
nlohmann::ordered_json activity_json(const std::vector<ActivityRow>& rows);

}  // namespace eventide::bench
