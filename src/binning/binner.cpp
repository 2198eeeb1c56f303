// event window -> voxel grid.
#include "src/binning/binner.h"

#include "src/core/error.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

namespace eventide {
namespace {

__extension__ using Wide = unsigned __int128;

constexpr int kTickBits = 19;
constexpr std::uint8_t kOldest = 8;  // where the age channel is clamped
constexpr std::uint64_t kOn = (std::uint64_t{1} << 32) + 1, kOff = 1 - (std::uint64_t{1} << 32);

/// n sum d^2 - (sum d)^2, exact before it becomes a double. It is n^2 times the variance.
double scaled_variance(std::uint64_t n, std::uint64_t sum, std::uint64_t squares) {
    if (n < (1U << 16) && squares < (std::uint64_t{1} << 47))  // (sum)^2 <= n squares < 2^63
        return double(std::int64_t(n * squares - sum * sum));
    return double(Wide{n} * squares - Wide{sum} * sum);
}

bool in_time_order(std::span<const Event> events) {
    return std::is_sorted(events.begin(), events.end(),
                          [](const Event& a, const Event& b) { return a.t < b.t; });
}

/// Of events in time order: how many are at most dt us after `begin`.
std::size_t first_after(std::span<const Event> events, SensorTime begin, std::int64_t dt) {
    const SensorTime last = begin + SensorDuration{dt};
    const auto after = std::upper_bound(events.begin(), events.end(), last,
                                        [](SensorTime t, const Event& e) { return t < e.t; });
    return std::size_t(after - events.begin());
}

}  // namespace

Binner::Binner(int bins, int height, int width) : bins_(bins), height_(height), width_(width) {
    if (bins < 1 || height < 1 || width < 1)
        throw Error(ErrorKind::usage,
                    "voxel grid: bins, height and width must be at least 1, found " +
                        std::to_string(bins) + ", " + std::to_string(height) + ", " +
                        std::to_string(width));
    const std::size_t pixels = std::size_t(height) * std::size_t(width);
    moments_.resize(pixels);
    touched_.resize((pixels + 63) / 64);
    ages_.assign(pixels, kOldest);
}

VoxelGrid Binner::make_output() const {
    VoxelGrid grid;
    grid.values = Array3<float>(height_, width_, 4 * bins_ + 1);
    grid.touched = {height_, width_};
    grid.ages = {height_, width_};
    return grid;
}

void Binner::reset() noexcept {
    std::fill(ages_.begin(), ages_.end(), kOldest);
}

void Binner::restore(const std::vector<std::uint8_t>& ages) {
    if (ages.size() != ages_.size())
        throw Error(ErrorKind::input, "voxel grid: expected the ages of " +
                                          std::to_string(ages_.size()) + " pixels, found " +
                                          std::to_string(ages.size()));
    std::ranges::transform(ages, ages_.begin(),
                           [](std::uint8_t age) { return std::min(age, kOldest); });
}

void Binner::process(const EventWindow& event_window, VoxelGrid& grid) noexcept {
    assert(grid.values.height() == height_ && grid.values.width() == width_ &&
           grid.values.channels() == 4 * bins_ + 1 &&
           grid.touched.values().size() == ages_.size() &&
           grid.ages.values().size() == ages_.size());
    grid.window = event_window.window;
    grid.events = event_window.events.size();
    grid.gap_before = event_window.gap_before;
    grid.reset_before = event_window.reset_before;
    grid.arrived = event_window.arrived;
    clear(grid);

    const std::int64_t width_us = event_window.window.width().count();
    const bool ordered = in_time_order(event_window.events);
    std::span<const Event> rest = event_window.events;
    for (int bin = 0; bin < bins_ && width_us > 0 && !rest.empty(); ++bin) {
        const BinTicks ticks = ticks_of(bin, width_us);
        if (ordered) {
            const std::size_t n = first_after(rest, event_window.window.begin, ticks.last_dt);
            add(rest.first(n), event_window.window.begin, ticks);
            rest = rest.subspan(n);
        } else {  // every bin looks at all events
            add(rest, event_window.window.begin, ticks);
        }
        write(bin, std::ldexp(double(width_us), -ticks.shift), grid);
    }
}

/// As of pixels without events. Where nothing moves, and nothing did when the grid was last used,
/// no more than each pixel's ages are looked at: a pixel that had events has another one now.
void Binner::clear(VoxelGrid& grid) noexcept {
    constexpr std::size_t kBlock = 64;  // pixels
    std::uint8_t* const ages = ages_.data();
    const std::uint8_t* const held = grid.ages.values().data();
    for (std::size_t begin = 0; begin < ages_.size(); begin += kBlock) {
        const std::size_t end = std::min(begin + kBlock, ages_.size());
        std::uint8_t differing = 0;
        for (std::size_t i = begin; i < end; ++i) {
            ages[i] = std::uint8_t(ages[i] + (ages[i] < kOldest ? 1 : 0));
            differing = std::uint8_t(differing + (ages[i] != held[i] ? 1 : 0));
        }
        if (differing > kBlock / 8)
            clear_all(begin, end, grid);
        else if (differing > 0)
            clear_differing(begin, end, grid);
    }
}

void Binner::clear_all(std::size_t begin, std::size_t end, VoxelGrid& grid) const noexcept {
    const std::size_t channels = std::size_t(grid.values.channels());
    float* const out = grid.values.values().data() + begin * channels;
    std::fill_n(out, (end - begin) * channels, 0.0F);
    for (std::size_t i = begin; i < end; ++i) set_age(i, grid);
    std::fill_n(grid.touched.values().data() + begin, end - begin, std::uint8_t{0});
}

void Binner::clear_differing(std::size_t begin, std::size_t end, VoxelGrid& grid) const noexcept {
    const std::size_t channels = std::size_t(grid.values.channels());
    for (std::size_t i = begin; i < end; ++i) {
        if (grid.ages.values()[i] == ages_[i]) continue;
        if (std::exchange(grid.touched.values()[i], std::uint8_t{0}) != 0)
            std::fill_n(grid.values.values().data() + i * channels, channels - 1, 0.0F);
        set_age(i, grid);
    }
}

void Binner::set_age(std::size_t pixel, VoxelGrid& grid) const noexcept {
    const std::size_t channels = std::size_t(grid.values.channels());
    grid.ages.values()[pixel] = ages_[pixel];
    grid.values.values()[(pixel + 1) * channels - 1] = float(ages_[pixel]) / float(kOldest);
}

Binner::BinTicks Binner::ticks_of(int bin, std::int64_t width_us) const {
    const std::int64_t origin = bin * width_us;
    const int bits = int(std::bit_width(std::uint64_t(width_us)));
    return {origin / bins_ + 1, (origin + width_us) / bins_, origin, std::max(0, bits - kTickBits)};
}

/// Sums those of the events that are in the bin.
void Binner::add(std::span<const Event> events, SensorTime begin, const BinTicks& bin) noexcept {
    constexpr std::size_t kAhead = 16;
    const auto pixel_of = [this](const Event& event) {
        return std::size_t(event.y) * std::size_t(width_) + event.x;
    };
    for (std::size_t i = 0; i < events.size(); ++i) {
        if (i + kAhead < events.size())
            __builtin_prefetch(&moments_[std::min(pixel_of(events[i + kAhead]), ages_.size() - 1)],
                               1);
        const Event& event = events[i];
        const std::int64_t dt = (event.t - begin).count();
        if (dt < bin.first_dt || dt > bin.last_dt || event.x >= width_ || event.y >= height_)
            continue;
        const std::size_t pixel = pixel_of(event);
        const std::uint64_t d = std::uint64_t(dt * bins_ - bin.origin) >> bin.shift;
        Moments& moments = moments_[pixel];
        moments.counts += event.polarity == Polarity::on ? kOn : kOff;
        moments.sum += d;
        moments.squares += d * d;
        touched_[pixel / 64] |= std::uint64_t{1} << (pixel % 64);
    }
}

/// The touched pixels' moments as four numbers, and all moments zero again.
void Binner::write(int bin, double ticks_per_bin, VoxelGrid& grid) noexcept {
    const std::size_t channels = std::size_t(grid.values.channels());
    float* const out = grid.values.values().data() + 4 * bin;
    float* const age_of_pixel = grid.values.values().data() + channels - 1;
    for (std::size_t word = 0; word < touched_.size(); ++word) {
        for (std::uint64_t bits = touched_[word]; bits != 0; bits &= bits - 1) {
            const std::size_t pixel = 64 * word + std::size_t(std::countr_zero(bits));
            Moments& moments = moments_[pixel];
            const std::uint64_t n = moments.counts & 0xFFFF'FFFF;
            const double scale = 1 / (double(n) * ticks_per_bin);
            float* const values = out + pixel * channels;
            values[0] = float(std::int32_t(moments.counts >> 32));
            values[1] = float(double(moments.sum) * scale);
            values[2] =
                n < 2 ? 0.0F
                      : float(std::sqrt(scaled_variance(n, moments.sum, moments.squares)) * scale);
            values[3] = float(n);
            age_of_pixel[pixel * channels] = 0;
            ages_[pixel] = grid.ages.values()[pixel] = 0;
            grid.touched.values()[pixel] = 1;
            moments = {};
        }
        touched_[word] = 0;
    }
}

}  // namespace eventide
