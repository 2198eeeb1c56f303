// An event sensor's pixels: light in, events out.
#pragma once

#include "src/core/array.h"
#include "src/core/event.h"
#include "src/simulate/sensor/sensor_settings.h"
#include "src/simulate/sensor/shot_noise.h"

#include <cstdint>
#include <span>
#include <vector>

namespace eventide {

/// Each pixel follows ln of its light through a low-pass and fires when it is a threshold away from
/// where it fired last. Between two steps ln light is taken to be a straight line, and so is the
/// followed value, which is where the events' times come from.
class EventSensor {
public:
    EventSensor(const SensorTraits& traits, int width, int height, Random random);

    /// The light (lux) that the pixels have settled to when the stream begins.
    void settle(const Array2<float>& lux, double gain);

    /// Light has gone to lux * gain in (begin, end]. Appends the events of that time, not yet in
    /// order; at most kMaxPerStep per pixel, after which the pixel catches up silently.
    void step(SensorTime begin, SensorTime end, const Array2<float>& lux, double gain,
              std::vector<Event>& events);

    static constexpr int kMaxPerStep = 64;

    const SensorTraits& traits() const { return traits_; }

private:
    struct Step;
    struct HotPixel {
        std::uint32_t pixel = 0;
        double rate_hz = 0, next_s = 0;
        double ready_s = 0;  // as it was when the step began
        double on_share = 1;
    };

    struct Lit {  // a pixel that fired for the light in this step
        std::uint32_t pixel = 0;
        double ready_s = 0;          // before that; later the latest noise event's
        std::size_t begin = 0, end;  // its events
    };

    void take_leaks();
    void cross(const Step& step, std::size_t pixel, std::vector<Event>& events);
    void add_shot_noise(const Step& step, std::span<const float> lux, double gain,
                        std::vector<Event>& events);
    void add_hot_pixels(const Step& step, std::vector<Event>& events);
    bool is_free(const Event& fired, std::span<const Event> others) const;
    Event event(const Step& step, std::size_t pixel, double share, Polarity polarity) const;

    SensorTraits traits_;
    int width_, height_;
    std::size_t pixels_;
    Random random_;
    // One number per pixel, padded to whole lanes.
    std::vector<float> ln_light_;      // at the latest step's end
    std::vector<float> now_, before_;  // ln light as the pixel sees it, at the step's ends
    std::vector<float> reference_;     // value at the last event, less what leaked before
                                       // leaking_s_; kHeld in refractory time
    std::vector<float> on_, off_;      // thresholds
    std::vector<float> leak_;          // per second, in ln
    double leaking_s_ = 0;             // time whose leaks are not yet in reference_
    std::vector<double> ready_s_;      // end of the refractory time, seconds since 0
    std::vector<Lit> lit_;             // in order of pixels
    ShotNoise noise_;
    std::vector<HotPixel> hot_;
};

}  // namespace eventide
