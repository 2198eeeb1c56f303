// The filters between parser and slicer.
#include "pipeline/filters/event_filter.h"

#include "src/core/error.h"

#include <cmath>
#include <string>
#include <utility>

namespace eventide {
namespace {

double hz_of(double period_us) {
    return period_us > 0 ? 1e6 / period_us : 0;
}

}  // namespace

void EventFilters::process(std::vector<Event>& events) {
    if (parts_.flicker) parts_.flicker->process(events);
    process_rest(events);
}

void EventFilters::release(SensorTime now, std::vector<Event>& events) {
    if (parts_.flicker) parts_.flicker->release(now, events);
    process_rest(events);
}

void EventFilters::flush(std::vector<Event>& events) {
    if (parts_.flicker) parts_.flicker->flush(events);
    process_rest(events);
}

void EventFilters::process_rest(std::vector<Event>& events) {
    if (parts_.hot_pixels) parts_.hot_pixels->process(events);
    if (parts_.noise) parts_.noise->process(events);
}

SensorTime EventFilters::known_until(SensorTime now) const {
    return parts_.flicker ? parts_.flicker->known_until(now) : now;
}

std::size_t EventFilters::held() const {
    return parts_.flicker ? parts_.flicker->held() : 0;
}

FlickerFound EventFilters::flicker() const {
    if (!parts_.flicker) return {};
    return {hz_of(parts_.flicker->period_us()), hz_of(parts_.flicker->last_period_us()),
            parts_.flicker->left_out()};
}

void EventFilters::forget_scene() noexcept {
    if (parts_.flicker) parts_.flicker->reset();
    if (parts_.noise) parts_.noise->reset();
}

EventFilters::State EventFilters::state() const {
    State state;
    if (parts_.flicker) state.flicker = parts_.flicker->state();
    if (parts_.noise) state.noise = parts_.noise->state();
    return state;
}

void EventFilters::restore(const State& state) {
    if (state.flicker.has_value() != parts_.flicker.has_value())
        throw Error(ErrorKind::input, "expected what is known of flickering light");
    if (state.noise.has_value() != parts_.noise.has_value())
        throw Error(ErrorKind::input, "expected what the noise filter knows");
    if (parts_.flicker) parts_.flicker->restore(*state.flicker);
    if (parts_.noise) parts_.noise->restore(*state.noise);
}

std::string flicker_remark(const FlickerFound& flicker) {
    if (flicker.left_out == 0) return {};
    return "light flickered at " + std::to_string(std::lround(flicker.last_hz)) +
           " Hz: " + std::to_string(flicker.left_out) + " events left out in pairs";
}

std::unique_ptr<EventFilters> event_filter(const EventFilterChoice& choice,
                                           const ModelConfig& model, int width, int height) {
    EventFilters::Parts parts;
    if (const auto longest = parse_lamp_flicker(choice.lamp_flicker, choice.can_wait))
        parts.flicker.emplace(width, height, *longest);
    if (choice.hot_pixels == "learn")
        parts.hot_pixels.emplace(width, height);
    else if (choice.hot_pixels != "off")
        parts.hot_pixels.emplace(width, height, choice.hot_pixels);
    if (const auto settings = parse_noise_filter(choice.noise_filter, model.noise_filter))
        parts.noise.emplace(width, height, *settings);
    if (!parts.flicker && !parts.hot_pixels && !parts.noise) return nullptr;
    return std::make_unique<EventFilters>(std::move(parts));
}

}  // namespace eventide
