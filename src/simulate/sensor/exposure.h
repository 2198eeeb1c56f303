// The ideal camera beside the events: how light becomes an image in [0, 1].
#pragma once

#include "src/core/array.h"
#include "src/simulate/scene/scene_settings.h"

#include <deque>

namespace eventide {

/// I = clip(black + gain(t) L^(1 / gamma), 0, white): what an APS with black level, saturation and
/// auto-exposure delivers. Black and gain are chosen so that mean and deviation are the drawn ones,
/// as far as the black level's range allows; the mean comes first.
class Exposure {
public:
    Exposure(const SceneSettings& settings, Random random);

    /// Whether meter() at t would do anything.
    bool due(double t_s) const;

    /// `light` as it is at t; times must not decrease. The first call sets the exposure.
    void meter(double t_s, const Array2<float>& light, double light_gain);
    void forget(double before_s);

    /// Light -> intensity, in place. t between the latest forget() and meter().
    void develop(double t_s, double light_gain, Array2<float>& image) const;

private:
    struct Setting {
        double t_s = 0, log_gain = 0;
    };
    double gain_for_mean(const std::vector<float>& signal, double gain) const;

    double mean_ = .4, deviation_ = .2, black_ = 0, white_ = 1, gamma_ = 1;
    Range black_range_;
    bool fixed_ = false;
    double lag_s_ = 1;
    std::deque<Setting> history_;
};

}  // namespace eventide
