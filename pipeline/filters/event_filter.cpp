// The filters between parser and slicer.
#include "pipeline/filters/event_filter.h"

#include "pipeline/filters/hot_pixels.h"
#include "src/binning/flicker_pairs.h"
#include "src/binning/noise_filter.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace eventide {
namespace {

double hz_of(double period_us) {
    return period_us > 0 ? 1e6 / period_us : 0;
}

class FilterChain final : public EventFilter {
public:
    FilterChain(std::optional<FlickerPairs> flicker, std::optional<HotPixelFilter> hot_pixels,
                std::optional<NoiseFilter> noise)
        : flicker_(std::move(flicker)),
          hot_pixels_(std::move(hot_pixels)),
          noise_(std::move(noise)) {}

    void process(std::vector<Event>& events) override {
        if (flicker_) flicker_->process(events);
        process_rest(events);
    }
    void release(SensorTime now, std::vector<Event>& events) override {
        if (flicker_) flicker_->release(now, events);
        process_rest(events);
    }
    void flush(std::vector<Event>& events) override {
        if (flicker_) flicker_->flush(events);
        process_rest(events);
    }
    SensorTime known_until(SensorTime now) const override {
        return flicker_ ? flicker_->known_until(now) : now;
    }
    std::size_t held() const override { return flicker_ ? flicker_->held() : 0; }
    FlickerFound flicker() const override {
        if (!flicker_) return {};
        return {hz_of(flicker_->period_us()), hz_of(flicker_->last_period_us()),
                flicker_->left_out()};
    }

    NoiseFilter* noise() { return noise_ ? &*noise_ : nullptr; }
    FlickerPairs* flicker_pairs() { return flicker_ ? &*flicker_ : nullptr; }

private:
    void process_rest(std::vector<Event>& events) {
        if (hot_pixels_) hot_pixels_->process(events);
        if (noise_) noise_->process(events);
    }
    std::optional<FlickerPairs> flicker_;
    std::optional<HotPixelFilter> hot_pixels_;
    std::optional<NoiseFilter> noise_;
};

}  // namespace

NoiseFilter* noise_filter_in(EventFilter* filter) {
    auto* const chain = dynamic_cast<FilterChain*>(filter);
    return chain == nullptr ? nullptr : chain->noise();
}

FlickerPairs* flicker_pairs_in(EventFilter* filter) {
    auto* const chain = dynamic_cast<FilterChain*>(filter);
    return chain == nullptr ? nullptr : chain->flicker_pairs();
}

std::string flicker_remark(const FlickerFound& flicker) {
    if (flicker.left_out == 0) return {};
    return "light flickered at " + std::to_string(std::lround(flicker.last_hz)) +
           " Hz: " + std::to_string(flicker.left_out) + " events left out in pairs";
}

std::unique_ptr<EventFilter> event_filter(const EventFilterChoice& choice, const ModelConfig& model,
                                          int width, int height) {
    std::optional<FlickerPairs> flicker;
    if (const auto longest = parse_lamp_flicker(choice.lamp_flicker, choice.can_wait))
        flicker.emplace(width, height, *longest);
    std::optional<HotPixelFilter> hot_pixels;
    if (choice.hot_pixels == "learn")
        hot_pixels.emplace(width, height);
    else if (choice.hot_pixels != "off")
        hot_pixels.emplace(width, height, choice.hot_pixels);
    std::optional<NoiseFilter> noise;
    if (const auto settings = parse_noise_filter(choice.noise_filter, model.noise_filter))
        noise.emplace(width, height, *settings);
    if (!flicker && !hot_pixels && !noise) return nullptr;
    return std::make_unique<FilterChain>(std::move(flicker), std::move(hot_pixels),
                                         std::move(noise));
}

}  // namespace eventide
