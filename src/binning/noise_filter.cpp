// Leaves out the events that nothing around them supports.
#include "src/binning/noise_filter.h"

#include "src/core/duration_text.h"
#include "src/core/error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eventide {
namespace {

constexpr SensorDuration kInterval{250'000};
constexpr double kPerInterval = 1 / double(kInterval.count());
// Of tiles by number of events: the one that tells the noise. Less, and dead corners tell it.
constexpr double kQuantile = .1, kBelow = 1.28;
// What is known of the noise follows what is seen by this share, upwards slowly: while everything
// moves, nothing tells it.
constexpr double kFall = .5, kGrowth = .1;
// Until it is known.
constexpr double kUsualNoiseHz = 2;
// Noise events of the eight neighbours within the time: 1 - exp(-m) (1 + m) = 6 % see two.
constexpr double kExpected = .4;
// A tile is quiet while it has no more events than its noise gives it, and so many deviations. Its
// noise, from the sensor's to so many times that, is learned while it is quiet; slowly, while its
// events stand alone.
constexpr double kQuietDeviations = 6, kMaxTimes = 4, kLearn = .1, kLearnSlowly = .02;
// Of the time within which neighbours support.
constexpr double kQuietTime = 2. / 3;
// Noise stands alone: of a tile's events, no more have kQuietSupport.
constexpr double kAloneShare = .02;
constexpr SensorDuration kHotInterval{2'000'000};

}  // namespace

NoiseFilter::NoiseFilter(int width, int height, const NoiseFilterSettings& settings)
    : settings_(settings),
      hot_pixels_(width, height, kHotHz, kHotInterval),
      newest_(width, height),
      tile_rows_(std::max(1, height / kTile)),
      tile_columns_(std::max(1, width / kTile)),
      // Of all tiles but the last ones, which are the only ones of a sensor that has room for one.
      tile_pixels_(double(tile_columns_ > 1 ? kTile : width) * (tile_rows_ > 1 ? kTile : height)),
      tiles_(std::size_t(tile_rows_) * std::size_t(tile_columns_)),
      sorted_(tiles_.size()),
      within_(settings.longest) {
    const auto [shortest, longest] = settings;
    if (shortest < SensorDuration{1} || longest < shortest || longest > kMaxTime)
        throw Error(ErrorKind::usage,
                    "noise filter: expected times from 1us to " + duration_text(kMaxTime) +
                        ", found " + duration_text(shortest) + " to " + duration_text(longest));
    set_noise(kUsualNoiseHz);
}

// In the interval before and what there is of this one, together so many intervals.
inline bool NoiseFilter::is_quiet(const Tile& tile, double intervals) const noexcept {
    const double noise = intervals * tile.noise;
    const double more = double(tile.events) + tile.before - noise - 1;
    return more * std::abs(more) <= kQuietDeviations * kQuietDeviations * noise;
}

// What a time that lies behind the interval ends.
void NoiseFilter::advance(SensorTime t) noexcept {
    end_interval();
    const auto silent = (t - *interval_) / kInterval;
    if (silent > 0) {
        for (Tile& tile : tiles_) tile.before = 0;
        set_noise(0);
    }
    *interval_ += silent * kInterval;
}

// True where the event's tile is quiet.
inline bool NoiseFilter::measure(const Event& event, bool hot, bool supported) noexcept {
    if (event.t - *interval_ >= kInterval) [[unlikely]]
        advance(event.t);
    // What a whole number of tiles leaves at the right and bottom belongs to the last ones.
    const int row = std::min(event.y / kTile, tile_rows_ - 1);
    const int column = std::min(event.x / kTile, tile_columns_ - 1);
    Tile& tile = tiles_[std::size_t(row) * std::size_t(tile_columns_) + std::size_t(column)];
    tile.events += hot ? 0 : 1;
    tile.supported += supported ? 1 : 0;
    const double of_two = 1 + double((event.t - *interval_).count()) * kPerInterval;
    const bool adapts = settings_.shortest != settings_.longest;
    return adapts && measured_ && is_quiet(tile, of_two);
}

void NoiseFilter::process(std::vector<Event>& events) noexcept {
    constexpr std::ptrdiff_t kAhead = 8;
    auto kept = events.begin();
    for (auto next = events.begin(); next != events.end(); ++next) {
        if (events.end() - next > kAhead) {
            newest_.prefetch(next[kAhead]);
            hot_pixels_.prefetch(next[kAhead]);
        }
        const Event event = *next;
        const bool begins = !last_ || event.t < *last_;
        if (!interval_ || event.t < *interval_) begin_stream(event.t);
        last_ = event.t;
        newest_.advance(event.t);
        const bool hot = hot_pixels_.is_hot(event);
        const NewestEvents::Around support = newest_.around(event, within_, quiet_within_);
        const bool surely = support.alike >= kQuietSupport;
        const bool quiet = measure(event, hot, surely);
        if (!hot) newest_.set(event);
        *kept = event;
        const bool supported = quiet ? surely : support.fired >= kSupport;
        kept += int(begins) | (int(supported) & int(!hot));  // no jumps: none could be foretold
    }
    events.erase(kept, events.end());
}

void NoiseFilter::reset() noexcept {
    hot_pixels_.reset();
    newest_.forget(SensorTime{});
    std::ranges::fill(tiles_, Tile{});
    interval_.reset();
    last_.reset();
    measured_ = false;
    set_noise(kUsualNoiseHz);
}

void NoiseFilter::begin_stream(SensorTime t) noexcept {
    newest_.forget(t);
    for (Tile& tile : tiles_) tile = {};
    interval_ = t;
    measured_ = false;
}

bool NoiseFilter::is_alone(const Tile& tile) noexcept {
    return tile.supported <= kAloneShare * tile.events + 1;
}

void NoiseFilter::end_interval() noexcept {
    *interval_ += kInterval;
    std::size_t alone = 0;
    for (const Tile& tile : tiles_)
        if (is_alone(tile)) sorted_[alone++] = tile.events;
    if (alone > 0) {
        const auto quiet = sorted_.begin() + std::ptrdiff_t(kQuantile * double(alone));
        std::nth_element(sorted_.begin(), quiet, sorted_.begin() + std::ptrdiff_t(alone));
        // Counts of random events lie around their mean; this one, below it by so many deviations.
        const double least = *quiet;
        const double mean =
            least > 0 ? least + kBelow * std::sqrt(least) + .5 * kBelow * kBelow : 0;
        const double hz = mean / (tile_pixels_ * 1e-6 * double(kInterval.count()));
        const double fall = measured_ ? kFall : 1;
        set_noise(noise_hz_ + (hz < noise_hz_ ? fall : kGrowth) * (hz - noise_hz_));
    }
    const double noise = noise_hz_ * tile_pixels_ * 1e-6 * double(kInterval.count());
    for (Tile& tile : tiles_) {
        if (!measured_)
            tile.noise = noise;
        else if (const bool quiet = is_quiet(tile, 2); quiet || is_alone(tile))
            tile.noise += (quiet ? kLearn : kLearnSlowly) * (tile.events - tile.noise);
        tile.noise = std::clamp(tile.noise, noise, kMaxTimes * noise);
        tile.before = std::exchange(tile.events, 0U);
        tile.supported = 0;
    }
    measured_ = true;
}

void NoiseFilter::set_noise(double hz) noexcept {
    noise_hz_ = hz;
    const double us = 1e6 * kExpected / (8 * hz);  // infinite without noise
    const auto clamped = [this](double time_us) {
        return std::clamp(SensorDuration{std::int64_t(std::min(time_us, 1e9))}, settings_.shortest,
                          settings_.longest);
    };
    within_ = clamped(us);
    quiet_within_ = clamped(us * kQuietTime);
}

NoiseFilter::State NoiseFilter::state() const {
    const SensorTime now = last_.value_or(SensorTime{});
    return {newest_.times(now), newest_.polarities(now), tiles_, interval_, last_, noise_hz_,
            measured_,          hot_pixels_.state()};
}

void NoiseFilter::restore(const State& state) {
    if (state.newest.size() != newest_.size() || state.polarity.size() != newest_.size() ||
        state.tiles.size() != tiles_.size())
        throw Error(ErrorKind::input, "noise filter: expected the state of " +
                                          std::to_string(newest_.size()) + " pixels and " +
                                          std::to_string(tiles_.size()) + " tiles, found " +
                                          std::to_string(state.newest.size()) + " and " +
                                          std::to_string(state.tiles.size()));
    hot_pixels_.restore(state.hot_pixels);
    newest_.restore(state.last.value_or(SensorTime{}), state.newest, state.polarity);
    tiles_ = state.tiles;
    interval_ = state.interval;
    last_ = state.last;
    measured_ = state.measured;
    set_noise(state.noise_hz);
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
