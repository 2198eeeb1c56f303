// The filters between parser and slicer, as a user chose them.
#pragma once

#include "pipeline/stages.h"
#include "src/model/model_config.h"

#include <memory>
#include <string>

namespace eventide {

struct EventFilterChoice {
    std::string hot_pixels;    ///< "off", "learn", or a file that lists pixels (HotPixelFilter)
    std::string noise_filter;  ///< parse_noise_filter()
    std::string lamp_flicker = "auto";  ///< parse_lamp_flicker()
    bool can_wait = false;              ///< a recording
};

class FlickerPairs;
class NoiseFilter;

// Those within a filter of event_filter(); null: there is none.
NoiseFilter* noise_filter_in(EventFilter* filter);
FlickerPairs* flicker_pairs_in(EventFilter* filter);

/// For people: what flickering light added; empty where it did not.
std::string flicker_remark(const FlickerFound& flicker);

/// What light's flicker adds first, then hot pixels, then what nothing supports; null where all
/// events stay. Throws Error (usage).
std::unique_ptr<EventFilter> event_filter(const EventFilterChoice& choice, const ModelConfig& model,
                                          int width, int height);

}  // namespace eventide
