// Which latent samples surround a query, and with which weights and offsets.
#pragma once

#include "src/model/model_config.h"

#include <array>
#include <cstdint>

namespace eventide {

/// Latent samples along an axis: one at every `stride`-th pixel, beginning with the first.
inline int latent_samples(int sensor_size, int stride) {
    return (sensor_size + stride - 1) / stride;
}

/// The one or two samples around a query along one axis. Sample `index + i` lies `offset[i]` before
/// the query (offset = query - sample) and has weight `weight[i]`; a sample of weight 0 is not
/// evaluated.
/// Weights add up to 1. As constructed: on sample 0, alone.
struct AxisSamples {
    int index = 0;
    std::array<double, 2> weight{1, 0};
    std::array<double, 2> offset{0, -1};
    friend bool operator==(const AxisSamples&, const AxisSamples&) = default;
};

/// Weight of the sample at `fraction` = 1, of two at 0 and 1. Smooth weights leave no creases at
/// samples and give more to the nearer one, which knows its surroundings best.
inline double blend_weight(double fraction, Blend blend) {
    return blend == Blend::linear ? fraction : fraction * fraction * (3 - 2 * fraction);
}

/// Output sample i of out_size, spread align-corners over sensor_size pixels, among samples at
/// every `stride`-th pixel. Past the last sample only that one is used, with its true offset.
/// Offsets are in latent pixels.
///
/// In latent pixels the query lies at i (sensor_size - 1) / ((out_size - 1) stride). 7 pixels over
/// a sensor of 4, stride 1, linear:
///
///     i                      0      1      2      3      4      5      6
///     index                  0      0      1      1      2      2      3
///     weight of index        1      .5     1      .5     1      .5     1
///     weight of index + 1    0      .5     0      .5     0      .5     0
inline AxisSamples sample_axis(int i, int out_size, int sensor_size, int stride, Blend blend) {
    const int samples = latent_samples(sensor_size, stride);
    if (out_size == 1) return {};
    // Whole numbers, so that a query on a sample is exactly on it.
    const std::int64_t numerator = std::int64_t(i) * (sensor_size - 1);
    const std::int64_t denominator = std::int64_t(out_size - 1) * stride;
    AxisSamples found;
    found.index = int(numerator / denominator);
    double fraction = double(numerator % denominator) / double(denominator);
    found.offset = {fraction, fraction - 1};
    const double next = blend_weight(fraction, blend);
    if (found.index < samples - 1) found.weight = {1 - next, next};
    return found;
}

/// The one or two samples around a time in event window k (docs/model.md, "Time"): those of event
/// windows k + index and k + index + 1. A live edge that fades takes k - 1 as it was shown last
/// (`from_before`: z_k is not read by it) and k.
///
///     samples              next known    jump    fade
///     index, index + 1     k, k + 1      k       k - 1, k
///     offsets              f, f - 1      f       1, f        f: `fraction`
///     weights              1 - f, f      1       1 - f, f
inline AxisSamples sample_time(double fraction, bool next_known, bool from_before) {
    AxisSamples found;
    if (next_known) {
        found.offset = {fraction, fraction - 1};
        found.weight = {1 - fraction, fraction};
    } else if (from_before) {
        found.index = -1;
        found.offset = {1, fraction};
        found.weight = {1 - fraction, fraction};
    } else {
        found.offset = {fraction, fraction - 1};
    }
    return found;
}

/// The same for what does not change, of a time sampled as `t`: the window's end; at its very begin
/// that of the window before is shown anyway.
inline AxisSamples sample_still_time(const AxisSamples& t, bool next_known, bool from_before) {
    const AxisSamples end = sample_time(1, next_known, from_before);
    return end.weight[1] != 0 && t.weight[1] == 0 ? t : end;
}

/// Codes that frames of a time read, as event windows relative to its own. Sample k + index reads
/// z_{k+index-1} and on, up to `newest`.
///
///     index 0, next 2 known     z_{k-1} .. z_{k+2}
///     index 0, next known       z_{k-1} .. z_{k+1}
///     index 0                   z_{k-1}, z_k
///     index -1, a fading edge   z_{k-2} .. z_k
struct CodesRead {
    int oldest = 0, newest = 0;
    friend bool operator==(const CodesRead&, const CodesRead&) = default;
};
inline CodesRead codes_read(int time_index, bool next_known, bool second_known) {
    if (time_index < 0) return {time_index - 1, 0};
    return {-1, next_known ? second_known ? 2 : 1 : 0};
}

/// The frame a renderer is asked for, in whole numbers.
struct FrameGeometry {
    int sensor_width = 0, sensor_height = 0;
    int width = 0, height = 0;                          ///< px, the whole frame
    int x = 0, y = 0, part_width = 0, part_height = 0;  ///< px, the wanted part of it
    friend bool operator==(const FrameGeometry&, const FrameGeometry&) = default;
};

}  // namespace eventide
