// Draws one camera.
#include "src/simulate/sensor/sensor_settings.h"

#include <initializer_list>

namespace eventide {

SensorSettings SensorSettings::ideal(double threshold) {
    SensorSettings s;
    s.threshold = {threshold, threshold};
    s.off_over_on = {1, 1};
    s.random_phase = false;
    for (Range SensorSettings::*effect :
         {&SensorSettings::mismatch, &SensorSettings::dark_lux, &SensorSettings::bandwidth_hz,
          &SensorSettings::bandwidth_hz_per_lux, &SensorSettings::refractory_s,
          &SensorSettings::leak_hz, &SensorSettings::leak_mismatch, &SensorSettings::shot_hz,
          &SensorSettings::hot_share, &SensorSettings::jitter_s,
          &SensorSettings::arbiter_hz_per_pixel, &SensorSettings::dropped})
        s.*effect = {0, 0};
    return s;
}

SensorTraits SensorTraits::draw(const SensorSettings& s, Random& random) {
    SensorTraits t;
    t.threshold_on = random.log_uniform(s.threshold);
    t.threshold_off = t.threshold_on * random.log_uniform(s.off_over_on);
    t.mismatch = random.uniform(s.mismatch);
    t.threshold_min = s.threshold_min;
    t.random_phase = s.random_phase;
    t.dark_lux = random.log_uniform(s.dark_lux);
    t.refractory_s = random.log_uniform(s.refractory_s);
    t.arbiter_hz_per_pixel = random.log_uniform(s.arbiter_hz_per_pixel);
    t.arbiter_wait_s = s.arbiter_wait_s;
    if (!random.chance(s.ideal_photoreceptor)) {
        t.bandwidth_hz = random.log_uniform(s.bandwidth_hz);
        t.bandwidth_hz_per_lux = random.log_uniform(s.bandwidth_hz_per_lux);
    }
    if (!random.chance(s.no_noise)) {
        t.leak_hz = random.uniform(s.leak_hz);
        t.leak_mismatch = random.uniform(s.leak_mismatch);
        t.shot_hz = random.log_uniform(s.shot_hz);
        t.shot_lux = random.log_uniform(s.shot_lux);
        t.shot_return_s = random.log_uniform(s.shot_return_s);
        t.shot_mismatch = random.uniform(s.shot_mismatch);
        t.hot_share = random.uniform(s.hot_share);
        t.hot_hz = s.hot_hz;
    }
    if (!random.chance(s.ideal_readout)) {
        t.jitter_s = random.uniform(s.jitter_s);
        t.dropped = random.uniform(s.dropped);
    }
    return t;
}

}  // namespace eventide
