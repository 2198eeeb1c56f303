// Leaves out the events that nothing around them supports.
#include "src/binning/noise_filter.h"

#include "src/core/duration_text.h"
#include "src/core/error.h"

#include <algorithm>

namespace eventide {
namespace {

constexpr SensorTime kNever = SensorTime::min();
constexpr SensorDuration kInterval{250'000};
// Of tiles by number of events: the one that tells the noise. Less, and dead corners tell it.
constexpr double kQuantile = .1;
// Noise is never more than was seen, and grows at this share of what is seen: while everything
// moves, nothing tells it.
constexpr double kGrowth = .1;
// Until it is known.
constexpr double kUsualNoiseHz = 2;
// Noise events of the eight neighbours within the time: 1 - exp(-m) (1 + m) = 6 % see two.
constexpr double kExpected = .4;

}  // namespace

NoiseFilter::NoiseFilter(int width, int height, const NoiseFilterSettings& settings)
    : settings_(settings),
      stride_(std::size_t(width) + 2),
      newest_(stride_ * (std::size_t(height) + 2), kNever),
      tile_rows_(std::max(1, height / kTile)),
      tile_columns_(std::max(1, width / kTile)),
      tile_pixels_(double(std::min(width, kTile)) * std::min(height, kTile)),
      counts_(std::size_t(tile_rows_) * std::size_t(tile_columns_)),
      sorted_(counts_.size()),
      within_(settings.longest) {
    const auto [shortest, longest] = settings;
    if (shortest < SensorDuration{1} || longest < shortest || longest > kMaxTime)
        throw Error(ErrorKind::usage,
                    "noise filter: expected times from 1us to " + duration_text(kMaxTime) +
                        ", found " + duration_text(shortest) + " to " + duration_text(longest));
    set_noise(kUsualNoiseHz);
}

void NoiseFilter::process(std::vector<Event>& events) noexcept {
    auto kept = events.begin();
    for (const Event& event : events) {
        measure(event);
        SensorTime* const own = &newest_[(std::size_t(event.y) + 1) * stride_ + event.x + 1];
        const bool begins = !last_ || event.t < *last_;
        const bool stays = begins || is_supported(own, event.t);
        last_ = event.t;
        *own = event.t;
        *kept = event;
        kept += stays ? 1 : 0;
    }
    events.erase(kept, events.end());
}

void NoiseFilter::measure(const Event& event) noexcept {
    if (!interval_ || event.t < *interval_) {  // a stream begins
        std::ranges::fill(counts_, 0U);
        interval_ = event.t;
    }
    if (event.t - *interval_ >= kInterval) {
        end_interval();
        const auto silent = (event.t - *interval_) / kInterval;
        if (silent > 0) set_noise(0);
        *interval_ += silent * kInterval;
    }
    const int row = event.y / kTile, column = event.x / kTile;
    if (row < tile_rows_ && column < tile_columns_)
        ++counts_[std::size_t(row) * std::size_t(tile_columns_) + std::size_t(column)];
}

void NoiseFilter::end_interval() noexcept {
    std::ranges::copy(counts_, sorted_.begin());
    std::ranges::fill(counts_, 0U);
    *interval_ += kInterval;
    const auto quiet = sorted_.begin() + std::ptrdiff_t(kQuantile * double(sorted_.size()));
    std::nth_element(sorted_.begin(), quiet, sorted_.end());
    const double hz = *quiet / (tile_pixels_ * 1e-6 * double(kInterval.count()));
    set_noise(hz < noise_hz_ ? hz : noise_hz_ + kGrowth * (hz - noise_hz_));
}

void NoiseFilter::set_noise(double hz) noexcept {
    noise_hz_ = hz;
    const double us = hz > 0 ? 1e6 * kExpected / (8 * hz) : double(settings_.longest.count());
    within_ = std::clamp(SensorDuration{std::int64_t(std::min(us, 1e9))}, settings_.shortest,
                         settings_.longest);
}

bool NoiseFilter::is_supported(const SensorTime* own, SensorTime t) const noexcept {
    // As unsigned numbers, so that one comparison refuses both what is old and what is not yet.
    const auto us = [](SensorTime time) { return std::uint64_t(to_us(time)); };
    const std::uint64_t now = us(t), within = std::uint64_t(within_.count());
    const auto in_time = [&](const SensorTime* at) { return now - us(*at) <= within ? 1 : 0; };
    const SensorTime *above = own - stride_, *below = own + stride_;
    return in_time(above - 1) + in_time(above) + in_time(above + 1) + in_time(own - 1) +
               in_time(own + 1) + in_time(below - 1) + in_time(below) + in_time(below + 1) >=
           kSupport;
}

std::string noise_filter_text(const NoiseFilterSettings& settings) {
    return settings == NoiseFilterSettings{} ? "auto" : duration_text(settings.longest);
}

std::optional<NoiseFilterSettings> parse_noise_filter(std::string_view text, bool models) {
    if (text == "off" || (text == "model" && !models)) return std::nullopt;
    if (text == "auto" || text == "model") return NoiseFilterSettings{};
    const auto time = read_duration(text);
    if (!time || *time < SensorDuration{1} || *time > NoiseFilter::kMaxTime)
        throw Error(ErrorKind::usage,
                    "noise filter: expected model, auto, off or a time from 1us to " +
                        duration_text(NoiseFilter::kMaxTime) + ", found '" + std::string{text} +
                        "'");
    return NoiseFilterSettings{*time, *time};
}

}  // namespace eventide
