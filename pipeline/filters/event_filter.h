// The filters between parser and slicer, as a user chose them.
#pragma once

#include "pipeline/filters/hot_pixels.h"
#include "pipeline/stages.h"
#include "src/binning/flicker_pairs.h"
#include "src/binning/noise_filter.h"
#include "src/model/model_config.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace eventide {

struct EventFilterChoice {
    std::string hot_pixels;    ///< "off", "learn", or a file that lists pixels (HotPixelFilter)
    std::string noise_filter;  ///< parse_noise_filter()
    std::string lamp_flicker = "auto";  ///< parse_lamp_flicker()
    bool can_wait = false;              ///< a recording
};

/// What light's flicker adds first, then hot pixels, then what nothing supports.
class EventFilters final : public EventFilter {
public:
    struct Parts {
        std::optional<FlickerPairs> flicker;
        std::optional<HotPixelFilter> hot_pixels;
        std::optional<NoiseFilter> noise;
    };
    explicit EventFilters(Parts parts) : parts_(std::move(parts)) {}

    void process(std::vector<Event>& events) override;
    void release(SensorTime now, std::vector<Event>& events) override;
    void flush(std::vector<Event>& events) override;
    SensorTime known_until(SensorTime now) const override;
    std::size_t held() const override;
    FlickerFound flicker() const override;

    /// What was learned of the scene and its light; hot pixels are of the sensor, and stay.
    void forget_scene() noexcept;

    /// What was learned, except for hot pixels: other filters can go on from it.
    struct State {
        std::optional<FlickerPairs::State> flicker;
        std::optional<NoiseFilter::State> noise;
        friend bool operator==(const State&, const State&) = default;
    };
    State state() const;
    /// Throws Error (input) for a state of other filters or of another sensor.
    void restore(const State& state);

private:
    void process_rest(std::vector<Event>& events);

    Parts parts_;
};

/// For people: what flickering light added; empty where it did not.
std::string flicker_remark(const FlickerFound& flicker);

/// As a user chose them; null where all events stay. Throws Error (usage).
std::unique_ptr<EventFilters> event_filter(const EventFilterChoice& choice,
                                           const ModelConfig& model, int width, int height);

}  // namespace eventide
