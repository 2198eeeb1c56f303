// The filters between parser and slicer.
#include "pipeline/filters/event_filter.h"

#include "pipeline/filters/hot_pixels.h"
#include "src/binning/noise_filter.h"

#include <optional>

namespace eventide {
namespace {

class FilterChain final : public EventFilter {
public:
    FilterChain(std::optional<HotPixelFilter> hot_pixels, std::optional<NoiseFilter> noise)
        : hot_pixels_(std::move(hot_pixels)), noise_(std::move(noise)) {}

    void process(std::vector<Event>& events) override {
        if (hot_pixels_) hot_pixels_->process(events);
        if (noise_) noise_->process(events);
    }

    NoiseFilter* noise() { return noise_ ? &*noise_ : nullptr; }

private:
    std::optional<HotPixelFilter> hot_pixels_;
    std::optional<NoiseFilter> noise_;
};

}  // namespace

NoiseFilter* noise_filter_in(EventFilter* filter) {
    auto* const chain = dynamic_cast<FilterChain*>(filter);
    return chain == nullptr ? nullptr : chain->noise();
}

std::unique_ptr<EventFilter> event_filter(const EventFilterChoice& choice, const ModelConfig& model,
                                          int width, int height) {
    std::optional<HotPixelFilter> hot_pixels;
    if (choice.hot_pixels == "learn")
        hot_pixels.emplace(width, height);
    else if (choice.hot_pixels != "off")
        hot_pixels.emplace(width, height, choice.hot_pixels);
    std::optional<NoiseFilter> noise;
    if (const auto settings = parse_noise_filter(choice.noise_filter, model.noise_filter))
        noise.emplace(width, height, *settings);
    if (!hot_pixels && !noise) return nullptr;
    return std::make_unique<FilterChain>(std::move(hot_pixels), std::move(noise));
}

}  // namespace eventide
