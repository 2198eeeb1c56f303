// Whole numbers and doubles as tensors of float, which a state file holds: in parts that float has
// exactly.
#include "apps/cli/run/state/stream_state.h"

#include "apps/cli/run/state/kept_state.h"

#include <algorithm>
#include <bit>

namespace eventide::app {

namespace {

constexpr const char* kPrefix = "stream.";
constexpr std::int64_t kExact = std::int64_t{1} << 24;  // float has all whole numbers up to it
constexpr int kTileValues = 7, kEventValues = 5;
/// Older than any filter looks back.
static_assert(NoiseFilter::kMaxTime.count() < kExact);

std::string text_of(SensorTime t) {
    return std::to_string(to_us(t));
}

std::string text_of(const std::optional<SensorTime>& t) {
    return t ? text_of(*t) : "none";
}

/// 16 bits each, the lowest first.
void put_bits(double value, std::vector<float>& into) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int shift = 0; shift < 64; shift += 16) into.push_back(float(bits >> shift & 0xFFFF));
}

Tensor made(std::vector<std::int64_t> shape, std::vector<float> values) {
    return {std::move(shape), std::move(values)};
}

/// Each as {2^24 us and us after `begin`, x, y, 1 where on}.
Tensor events_after(SensorTime begin, const std::vector<Event>& events) {
    std::vector<float> values;
    for (const Event& event : events) {
        const std::int64_t dt = (event.t - begin).count(), high = dt / kExact, low = dt % kExact;
        values.insert(values.end(), {float(high), float(low), float(event.x), float(event.y),
                                     event.polarity == Polarity::on ? 1.F : 0.F});
    }
    return made({std::int64_t(events.size()), kEventValues}, std::move(values));
}

void put_slicer(const PipelineState& stream, TensorFile& file) {
    const Slicer::State& slicer = stream.slicer;
    auto& words = file.metadata;
    words["stream.t_us"] = text_of(stream.t);
    words["stream.begin_us"] = text_of(slicer.begin);
    words["stream.origin_us"] = text_of(slicer.origin);
    words["stream.newest_us"] = text_of(slicer.newest);
    words["stream.newest_event_us"] = text_of(slicer.newest_event);
    words["stream.heard_us"] = text_of(slicer.heard);
    words["stream.same_time"] = std::to_string(slicer.same_time);
    words["stream.silent"] = std::to_string(slicer.silent);
    words["stream.gap"] = slicer.gap ? "1" : "0";
    file.tensors["stream.events"] = events_after(slicer.begin, slicer.events);
}

void put_flicker(const FlickerPairs::State& flicker, const PipelineState& stream, int width,
                 TensorFile& file) {
    const FlickerPeriod::State& period = flicker.period;
    file.metadata["stream.flicker_block_us"] = text_of(period.block);
    file.metadata["stream.flicker_since_us"] = text_of(period.since);
    std::vector<float> us, rises, when;
    put_bits(period.period_us, us);
    put_bits(period.found_us, us);
    us.push_back(float(period.unsaid));
    for (const std::uint32_t rise : period.rises)
        rises.insert(rises.end(), {float(rise >> 16), float(rise & 0xFFFF)});
    // Few ticks have any.
    for (std::size_t tick = 0; tick < period.when.size(); ++tick)
        if (period.when[tick] > 0) when.insert(when.end(), {float(tick), float(period.when[tick])});
    file.tensors["stream.flicker_period"] = made({9}, std::move(us));
    file.tensors["stream.flicker_rises"] =
        made({std::int64_t(period.rises.size()) / width, width, 2}, std::move(rises));
    file.tensors["stream.flicker_intervals"] =
        made({FlickerPeriod::kBins}, {period.intervals.begin(), period.intervals.end()});
    const std::int64_t ticks = std::int64_t(when.size()) / 2;
    file.tensors["stream.flicker_when"] = made({ticks, 2}, std::move(when));
    file.tensors["stream.flicker_held"] = events_after(stream.slicer.begin, flicker.held);
}

void put_noise(const NoiseFilter::State& noise, SensorTime t, std::int64_t width,
               TensorFile& file) {
    auto& words = file.metadata;
    words["stream.noise_interval_us"] = text_of(noise.interval);
    words["stream.noise_last_us"] = text_of(noise.last);
    words["stream.noise_measured"] = noise.measured ? "1" : "0";
    words["stream.hot_end_us"] = text_of(noise.hot_pixels.interval_end);
    std::vector<float> hz, ages, on, tiles;
    put_bits(noise.noise_hz, hz);
    for (const SensorTime newest : noise.newest) {
        const bool old = newest == SensorTime::min() || (t - newest).count() >= kExact;
        ages.push_back(old ? -1.F : float((t - newest).count()));
    }
    for (const Polarity polarity : noise.polarity) on.push_back(polarity == Polarity::on ? 1 : 0);
    for (const NoiseFilter::Tile& tile : noise.tiles) {
        tiles.insert(tiles.end(), {float(tile.events), float(tile.before), float(tile.supported)});
        put_bits(tile.noise, tiles);
    }
    const std::int64_t wide = width + 2, high = std::int64_t(ages.size()) / wide;
    file.tensors["stream.noise_hz"] = made({4}, std::move(hz));
    file.tensors["stream.noise_ages"] = made({high, wide}, std::move(ages));
    file.tensors["stream.noise_on"] = made({high, wide}, std::move(on));
    file.tensors["stream.noise_tiles"] =
        made({std::int64_t(noise.tiles.size()), kTileValues}, std::move(tiles));
    const HotPixels::State& hot = noise.hot_pixels;
    file.tensors["stream.hot_events"] =
        made({high - 2, width}, {hot.events.begin(), hot.events.end()});
    file.tensors["stream.hot"] = made({high - 2, width}, {hot.hot.begin(), hot.hot.end()});
}

double bits_at(const std::vector<float>& values, std::size_t at) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < 4; ++i) bits |= std::uint64_t(values[at + i]) << (16 * i);
    return std::bit_cast<double>(bits);
}

std::vector<Event> events_after(const KeptState& kept, const std::string& key, SensorTime begin,
                                int width, int height) {
    std::vector<Event> events;
    const auto& values = kept.tensor(key, {-1, kEventValues}, 0, float(kExact));
    for (std::size_t i = 0; i + kEventValues <= values.size(); i += kEventValues) {
        if (values[i + 2] >= float(width) || values[i + 3] >= float(height))
            kept.refuse("expected events on a sensor of " + std::to_string(width) + "x" +
                        std::to_string(height) + ", found one at " +
                        std::to_string(int(values[i + 2])) + ", " +
                        std::to_string(int(values[i + 3])));
        const SensorDuration dt{std::int64_t(values[i]) * kExact + std::int64_t(values[i + 1])};
        events.push_back({begin + dt, std::uint16_t(values[i + 2]), std::uint16_t(values[i + 3]),
                          values[i + 4] != 0 ? Polarity::on : Polarity::off});
    }
    return events;
}

FlickerPairs::State flicker_of(const KeptState& kept, SensorTime begin, int width, int height) {
    FlickerPairs::State flicker;
    flicker.period.block = kept.time_or_none("stream.flicker_block_us");
    const auto& period = kept.tensor("stream.flicker_period", {9}, 0, 0xFFFF);
    flicker.period.period_us = bits_at(period, 0);
    flicker.period.found_us = bits_at(period, 4);
    flicker.period.unsaid = int(period[8]);
    const auto& rises = kept.tensor("stream.flicker_rises", {height, width, 2}, 0, 0xFFFF);
    for (std::size_t i = 0; i + 1 < rises.size(); i += 2)
        flicker.period.rises.push_back(std::uint32_t(rises[i]) << 16 | std::uint32_t(rises[i + 1]));
    flicker.period.since = kept.time("stream.flicker_since_us");
    const auto& intervals =
        kept.tensor("stream.flicker_intervals", {FlickerPeriod::kBins}, 0, float(kExact));
    std::ranges::transform(intervals, flicker.period.intervals.begin(),
                           [](float n) { return std::uint32_t(n); });
    flicker.period.when.resize(std::size_t(FlickerPeriod::kTicks));
    const auto& when = kept.tensor("stream.flicker_when", {-1, 2}, 0, float(kExact));
    for (std::size_t i = 0; i + 1 < when.size(); i += 2) {
        if (when[i] >= float(FlickerPeriod::kTicks))
            kept.refuse("expected rises within a second, found one in tick " +
                        std::to_string(int(when[i])));
        flicker.period.when[std::size_t(when[i])] = std::uint32_t(when[i + 1]);
    }
    flicker.held = events_after(kept, "stream.flicker_held", begin, width, height);
    if (!std::ranges::is_sorted(flicker.held, {}, &Event::t))
        kept.refuse("expected events in the order of time, found others");
    return flicker;
}

PipelineState stream_of(const KeptState& kept, int width, int height) {
    PipelineState stream;
    stream.t = kept.time("stream.t_us");
    Slicer::State& slicer = stream.slicer;
    slicer.begin = kept.time("stream.begin_us");
    slicer.origin = kept.time("stream.origin_us");
    slicer.newest = kept.time("stream.newest_us");
    slicer.newest_event = kept.time("stream.newest_event_us");
    slicer.heard = kept.time("stream.heard_us");
    slicer.same_time = std::uint64_t(kept.number("stream.same_time"));
    slicer.silent = int(std::clamp<std::int64_t>(kept.number("stream.silent"), 0, 1 << 20));
    slicer.gap = kept.number("stream.gap") != 0;
    slicer.events = events_after(kept, "stream.events", slicer.begin, width, height);
    const auto& ages = kept.tensor("stream.ages", {height, width}, 0, 255);
    stream.ages.assign(ages.begin(), ages.end());
    return stream;
}

NoiseFilter::State noise_of(const KeptState& kept, SensorTime t, int width, int height) {
    NoiseFilter::State noise;
    noise.interval = kept.time_or_none("stream.noise_interval_us");
    noise.last = kept.time_or_none("stream.noise_last_us");
    noise.measured = kept.number("stream.noise_measured") != 0;
    noise.noise_hz = bits_at(kept.tensor("stream.noise_hz", {4}, 0, 0xFFFF), 0);
    if (!(noise.noise_hz >= 0 && noise.noise_hz <= 1e9))
        kept.refuse("expected a rate of noise, found " + std::to_string(noise.noise_hz) + " Hz");
    const std::vector<std::int64_t> rimmed{height + 2, width + 2}, sensor{height, width};
    for (const float age : kept.tensor("stream.noise_ages", rimmed, -1, float(kExact)))
        noise.newest.push_back(age < 0 ? SensorTime::min() : t - SensorDuration{std::int64_t(age)});
    for (const float on : kept.tensor("stream.noise_on", rimmed, 0, 1))
        noise.polarity.push_back(on != 0 ? Polarity::on : Polarity::off);
    const auto& tiles = kept.tensor("stream.noise_tiles", {-1, kTileValues}, 0, float(kExact));
    for (std::size_t i = 0; i + kTileValues <= tiles.size(); i += kTileValues) {
        NoiseFilter::Tile tile{std::uint32_t(tiles[i]), std::uint32_t(tiles[i + 1]),
                               std::uint32_t(tiles[i + 2]), bits_at(tiles, i + 3)};
        if (!(tile.noise >= 0 && tile.noise <= 1e9))
            kept.refuse("expected the noise of a tile, found " + std::to_string(tile.noise));
        noise.tiles.push_back(tile);
    }
    const auto& events = kept.tensor("stream.hot_events", sensor, 0, float(kExact));
    noise.hot_pixels.events.assign(events.begin(), events.end());
    const auto& hot = kept.tensor("stream.hot", sensor, 0, 1);
    noise.hot_pixels.hot.assign(hot.begin(), hot.end());
    noise.hot_pixels.interval_end = kept.time_or_none("stream.hot_end_us");
    return noise;
}

}  // namespace

void put_stream_state(const StreamState& state, int width, TensorFile& file) {
    file.metadata["stream.window"] = state.window;
    file.metadata["stream.noise_filter"] = state.noise_filter;
    put_slicer(state.stream, file);
    const auto& ages = state.stream.ages;
    file.tensors["stream.ages"] =
        made({std::int64_t(ages.size()) / width, width}, {ages.begin(), ages.end()});
    if (state.filters.noise) put_noise(*state.filters.noise, state.stream.t, width, file);
    file.metadata["stream.lamp_flicker"] = state.lamp_flicker;
    if (state.filters.flicker) put_flicker(*state.filters.flicker, state.stream, width, file);
}

std::optional<StreamState> take_stream_state(TensorFile& file, const std::string& name, int width,
                                             int height) {
    const KeptState kept{file, name};
    if (!kept.has("stream.events")) return std::nullopt;
    StreamState state;
    state.window = kept.word("stream.window");
    state.noise_filter = kept.word("stream.noise_filter");
    state.stream = stream_of(kept, width, height);
    if (kept.has("stream.noise_hz"))
        state.filters.noise = noise_of(kept, state.stream.t, width, height);
    state.lamp_flicker = kept.word("stream.lamp_flicker");
    if (kept.has("stream.flicker_period"))
        state.filters.flicker = flicker_of(kept, state.stream.slicer.begin, width, height);
    std::erase_if(file.tensors, [](const auto& each) { return each.first.starts_with(kPrefix); });
    return state;
}

}  // namespace eventide::app
