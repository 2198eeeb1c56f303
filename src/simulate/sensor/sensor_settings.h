// What an event sensor is drawn from: one set of values per simulated camera.
#pragma once

#include "src/simulate/random.h"

namespace eventide {

/// Every effect is off where its range is {0, 0}. "log-uniform" ranges that begin at 0 are drawn
/// evenly.
struct SensorSettings {
    Range threshold{.06, 1.0};   ///< log-uniform; ON, ln of the light's change
    Range off_over_on{.6, 1.6};  ///< log-uniform; asymmetry
    Range mismatch{.01, .12};    ///< uniform; deviation between pixels, share of the threshold
    double threshold_min = .01;  ///< no pixel is more sensitive
    bool random_phase = true;    ///< pixels start anywhere between their thresholds
    Range dark_lux{.001, .5};    ///< log-uniform; dark current, as light that is always there

    Range bandwidth_hz{150, 5000};       ///< log-uniform; photoreceptor in bright light
    Range bandwidth_hz_per_lux{2, 200};  ///< log-uniform; in dim light it grows with the light
    Range refractory_s{.00002, .002};    ///< log-uniform
    Range leak_hz{0, .4};                ///< uniform; ON events per pixel without any change
    Range leak_mismatch{.1, .5};         ///< uniform; deviation between pixels, share of the rate
    Range shot_hz{.01, 3};               ///< log-uniform; noise events per pixel in the dark ...
    Range shot_lux{1, 100};              ///< log-uniform; ... half as many at this light
    Range shot_return_s{.002, .03};  ///< log-uniform; mean time from a noise event to its opposite
    Range shot_mismatch{.2, 1.2};    ///< uniform; deviation between pixels of the rate's ln
    Range hot_share{0, .001};        ///< uniform; share of pixels that fire by themselves
    Range hot_hz{5, 1000};           ///< log-uniform per hot pixel
    Range jitter_s{0, .0002};        ///< uniform; mean of the exponential delay of read-out
    /// log-uniform; events per second that the bus can carry, over the number of pixels (a
    /// DAVIS240: 12e6 / 43200 = 280)
    Range arbiter_hz_per_pixel{100, 3000};
    double arbiter_wait_s = .005;  ///< events that would have to wait longer are dropped
    Range dropped{0, .02};         ///< uniform; share of events lost on the way

    // What one camera in several is like: an effect is off with these probabilities.
    double ideal_photoreceptor = .2, no_noise = .15;
    double ideal_readout = .3;  ///< neither jitter nor losses; the bus's limit stays

    /// Nothing but thresholds, all equal: for tests and comparisons.
    static SensorSettings ideal(double threshold);
};

/// One camera drawn from the settings.
struct SensorTraits {
    double threshold_on = .2, threshold_off = .2, mismatch = 0, threshold_min = .01;
    bool random_phase = false;
    double dark_lux = 0;
    double bandwidth_hz = 0, bandwidth_hz_per_lux = 0;
    double refractory_s = 0;
    double leak_hz = 0, leak_mismatch = 0;
    double shot_hz = 0, shot_lux = 0, shot_return_s = .005, shot_mismatch = 0;
    double hot_share = 0;
    Range hot_hz;
    double jitter_s = 0, arbiter_hz_per_pixel = 0, arbiter_wait_s = 0, dropped = 0;

    static SensorTraits draw(const SensorSettings& settings, Random& random);
};

}  // namespace eventide
