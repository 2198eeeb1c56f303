// Leaves out the events of pixels that see a lamp or a screen flicker.
#include "pipeline/filters/flicker_filter.h"

#include "pipeline/filters/pixel_filters.h"

#include <algorithm>
#include <cassert>

namespace eventide {
namespace {

// A cycle may differ from those before it by 3/20 of them.
constexpr int kTolerance = 3, kOf = 20;

}  // namespace

FlickerFilter::FlickerFilter(const SensorPixels& size, int low_hz, int high_hz)
    : size_(size),
      shortest_(1'000'000 / high_hz),
      longest_(1'000'000 / low_hz),
      pixels_(std::size_t(size.width) * std::size_t(size.height)) {
    assert(low_hz >= kLowestHz && low_hz < high_hz && high_hz <= kHighestHz);
}

void FlickerFilter::learn(Pixel& pixel, SensorDuration interval) const {
    const bool is_cycle = !pixel.rose_again;
    for (int cycles = 1; cycles <= kCycles && pixel.agreed > 0 && is_cycle; ++cycles) {
        const SensorDuration cycle = interval / cycles;
        const SensorDuration off = std::chrono::abs(cycle - pixel.cycle);
        if (cycle < shortest_ || cycle > longest_ || kOf * off > kTolerance * pixel.cycle) continue;
        pixel.cycle = (pixel.cycle + cycle) / 2;
        // One more than is needed, so that one interval that disagrees is forgiven.
        pixel.agreed = std::uint8_t(std::min(pixel.agreed + 1, kIntervals + 1));
        return;
    }
    if (pixel.agreed > 0) --pixel.agreed;
    if (pixel.agreed > 0 || interval > longest_ || !is_cycle) return;
    pixel.cycle = interval;
    pixel.agreed = 1;
}

bool FlickerFilter::flickers(const Event& event) {
    Pixel& pixel = pixels_[std::size_t(event.y) * std::size_t(size_.width) + std::size_t(event.x)];
    const bool on = event.polarity == Polarity::on, rises = on && !pixel.was_on;
    pixel.was_on = on;
    const bool known = is_recent(pixel.rise, event.t, kCycles * longest_ + longest_ / 2);
    if (!known) pixel.agreed = 0;
    if (rises && known && event.t - pixel.rise < shortest_) {
        pixel.rose_again = true;
    } else if (rises) {
        if (known) learn(pixel, event.t - pixel.rise);
        pixel.rise = event.t;
        pixel.rose_again = false;
    }
    return pixel.agreed >= kIntervals;
}

void FlickerFilter::process(Batch& batch) {
    std::erase_if(batch.events, [this](const Event& event) { return flickers(event); });
}

}  // namespace eventide
