// Noise events of an event sensor's pixels.
//
// A pixel's noise swings about the light: having fired ON for nothing it soon fires OFF for
// nothing, so its polarities add up to next to nothing however long it goes on. On a DAVIS240 that
// stands still in a bright room (camerashake_b, last 0.2 s; 15 events per second and pixel) 94 of
// 100 events have the opposite polarity of the one before, their sum's variance is .6 where single
// events that know nothing of each other would have 2.8, half of the second ones come within 9 ms,
// and the number of events per pixel has a variance of 13 about a mean of 2.8.
#pragma once

#include "src/core/event.h"
#include "src/simulate/random.h"
#include "src/simulate/sensor/sensor_settings.h"

#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

namespace eventide {

class ShotNoise {
public:
    ShotNoise(const SensorTraits& traits, std::size_t pixels, Random random);

    /// lux of a pixel, as it is at the time of the call.
    using Light = std::function<double(std::size_t pixel)>;
    /// Takes an event, or returns false where the pixel cannot fire at that time.
    using Fire = std::function<bool(std::size_t pixel, double t_s, Polarity polarity)>;

    /// All noise of the time since the last call, in order.
    void until(double end_s, const Light& light, const Fire& fire);

private:
    struct Return {
        double t_s = 0;
        std::uint32_t pixel = 0;
        Polarity polarity = Polarity::on;
        bool operator>(const Return& other) const { return t_s > other.t_s; }
    };
    void begin_swing(const Light& light, const Fire& fire);
    void end_swing(const Fire& fire);

    double lux_, return_s_;
    Random random_;
    std::vector<double> up_to_;    // begins of swings per second in the dark, of pixels 0 to i
    std::vector<Polarity> first_;  // of the latest swing's two events
    std::vector<bool> swings_;     // pixels that have fired once and not yet back
    double next_s_;                // next candidate of the whole sensor
    std::priority_queue<Return, std::vector<Return>, std::greater<>> returns_;
};

}  // namespace eventide
