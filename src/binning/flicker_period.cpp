// A comb laid over the times between rises.
#include "src/binning/flicker_period.h"

#include "src/core/error.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <string>

namespace eventide {
namespace {

constexpr double kFromWhole = .15;  // periods: as far from a whole number, or from between
constexpr double kPeriods = 3.5;    // as long as intervals may be
// (whole - between) / (whole + between): to begin with, and where the period is as before.
// Recordings in lamps' light have .38 to .99, others .38 at most (motion over few pixels), usually
// .1.
constexpr double kContrast = .45, kContrastAsBefore = .25;
constexpr double kShare = .05;     // of all intervals, near whole numbers of periods
constexpr double kAsBefore = .03;  // of the period
// Resultant of the phases of all rises over how many more intervals lie near whole numbers of
// periods: lamps have .9 to 4.4 (their intervals lie between whole numbers, too), wheels about 0.
constexpr double kInStep = .4, kInStepAsBefore = .25;
constexpr std::uint32_t kEnough = 300;  // intervals, to say anything
constexpr double kStep = 1.01;          // from one period that is tried to the next

bool is_as_before(double period_us, double before_us) {
    return std::abs(period_us - before_us) <= kAsBefore * before_us;
}

bool is_in_range(double period_us) {
    return period_us >= FlickerPeriod::kShortestUs && period_us <= FlickerPeriod::kLongestUs;
}

}  // namespace

FlickerPeriod::FlickerPeriod(int width, int height) : width_(width) {
    state_.rises.resize(std::size_t(width) * std::size_t(height));
    state_.when.resize(std::size_t(kTicks));
}

void FlickerPeriod::reset() noexcept {
    std::ranges::fill(state_.rises, 0U);
    clear_intervals();
    state_.block.reset();
    state_.since = {};
    state_.period_us = state_.found_us = 0;
    state_.unsaid = 0;
}

void FlickerPeriod::restore(const State& state) {
    if (state.rises.size() != state_.rises.size())
        throw Error(ErrorKind::input,
                    "flicker: expected what is known of " + std::to_string(state_.rises.size()) +
                        " pixels, found that of " + std::to_string(state.rises.size()));
    if (state.when.size() != state_.when.size())
        throw Error(ErrorKind::input, "flicker: expected the times of rises in " +
                                          std::to_string(kTicks) + " parts, found " +
                                          std::to_string(state.when.size()));
    if (state.block &&
        (state.since > *state.block || *state.block - state.since > (kMostUnsaid - 1) * kBlock))
        throw Error(ErrorKind::input,
                    "flicker: expected rises since a second before the block or less");
    for (const double us : {state.period_us, state.found_us})
        if (us != 0 && !is_in_range(us))
            throw Error(ErrorKind::input, "flicker: expected a period of " +
                                              std::to_string(int(kShortestUs)) + " to " +
                                              std::to_string(int(kLongestUs)) + " us, found " +
                                              std::to_string(us));
    state_ = state;
    counted_ = std::accumulate(state.intervals.begin(), state.intervals.end(), std::uint32_t{0});
}

void FlickerPeriod::watch(const Event& event) noexcept {
    if (!state_.block || event.t < *state_.block) {
        forget_rises(event.t);
        begin_block(event.t);
    }
    if (event.t - *state_.block >= kBlock) {
        end_block();
        begin_block(event.t);
    }
    note(event);
}

/// Of a clock that begins at t: no pixel has risen by it.
void FlickerPeriod::forget_rises(SensorTime t) noexcept {
    constexpr SensorDuration kLongAgo{1'000'000};
    const auto long_ago = std::uint32_t((t - kLongAgo).time_since_epoch().count()) << 1;
    for (std::uint32_t& rise : state_.rises) rise = long_ago | (rise & 1);
}

/// Rises of a second ago, before a pause, are forgotten.
void FlickerPeriod::begin_block(SensorTime t) noexcept {
    state_.block = t;
    const bool is_long_ago = t < state_.since || t - state_.since > (kMostUnsaid - 1) * kBlock;
    if (counted_ > 0 && is_long_ago) clear_intervals();
    if (counted_ == 0) state_.since = t;
}

void FlickerPeriod::clear_intervals() noexcept {
    state_.intervals.fill(0);
    std::ranges::fill(state_.when, 0U);
    counted_ = 0;
}

void FlickerPeriod::note(const Event& event) noexcept {
    std::uint32_t& last = state_.rises[std::size_t(event.y) * std::size_t(width_) + event.x];
    const bool was_on = (last & 1) != 0, is_on = event.polarity == Polarity::on;
    if (is_on == was_on) return;
    if (!is_on) {
        last &= ~std::uint32_t{1};
        return;
    }
    const std::uint32_t now = std::uint32_t(event.t.time_since_epoch().count()) << 1;
    const std::uint32_t interval = (now - (last & ~std::uint32_t{1})) >> 1;
    last = now | 1;
    const std::uint32_t bin = interval / kBinUs;
    const std::int64_t tick = (event.t - state_.since).count() / kTickUs;
    if (bin >= kBins || tick >= kTicks) return;
    ++state_.intervals[bin];
    ++state_.when[std::size_t(tick)];
    ++counted_;
}

FlickerPeriod::Cumulative FlickerPeriod::cumulative() const noexcept {
    Cumulative before{};
    std::partial_sum(state_.intervals.begin(), state_.intervals.end(), before.begin() + 1);
    return before;
}

/// Of bins whose middle lies within.
FlickerPeriod::Comb FlickerPeriod::comb(const Cumulative& before, double period_us) noexcept {
    double whole = 0, between = 0;
    int wholes = 0, betweens = 0;
    const auto add = [&](double from, double to, double& intervals, int& bins) {
        const auto edge = [&](double periods) {
            return std::clamp(int(std::ceil(periods * period_us / kBinUs - .5)), 0, kBins);
        };
        const int first = edge(from), end = edge(to);
        intervals += before[std::size_t(end)] - before[std::size_t(first)];
        bins += end - first;
    };
    for (int n = 0; n <= kPeriods; ++n) {
        if (n > 0) add(n - kFromWhole, n + kFromWhole, whole, wholes);
        add(n > 0 ? n + .5 - kFromWhole : .5, std::min(n + .5 + kFromWhole, kPeriods), between,
            betweens);
    }
    if (wholes == 0 || betweens == 0) return {};
    Comb found{whole / wholes, between / betweens, 0};
    found.excess = (found.whole - found.between) * wholes;
    return found;
}

/// By the mean of what is near whole numbers of periods.
double FlickerPeriod::refined(double period_us) const noexcept {
    double time = 0, periods = 0;
    for (int i = 0; i < kBins; ++i) {
        const double at = (i + .5) * kBinUs, count = state_.intervals[std::size_t(i)];
        const double whole = std::round(at / period_us);
        if (whole < 1 || whole > 3 || std::abs(at / period_us - whole) > kFromWhole) continue;
        time += count * at;
        periods += count * whole;
    }
    return periods > 0 ? time / periods : period_us;
}

/// As many as are in use, in whole blocks.
int FlickerPeriod::ticks() const noexcept {
    // What comes before a block has ended may be as late as it is long.
    return std::min(kTicks, int((*state_.block - state_.since) / kBlock + 2) * kTicksABlock);
}

bool FlickerPeriod::is_periodic(const Comb& comb, double least) const noexcept {
    return comb.whole - comb.between >= least * (comb.whole + comb.between) &&
           comb.excess >= kShare * counted_;
}

/// |sum of exp(i phase)| over the rises, phases of a `part`-th of the period: their number where
/// all come at one time of it, about the root of that where they come at any. By stretches of a
/// block each, so that the period need not be exact.
double FlickerPeriod::in_phase(double period_us, int part) const noexcept {
    const std::complex<double> turn =
        std::polar(1.0, 2 * std::numbers::pi * part * kTickUs / period_us);
    double all = 0;
    for (int begin = 0; begin < ticks(); begin += kTicksABlock) {
        std::complex<double> sum = 0, at = 1;
        for (int i = begin; i < begin + kTicksABlock; ++i, at *= turn)
            sum += double(state_.when[std::size_t(i)]) * at;
        all += std::abs(sum);
    }
    return all;
}

/// Whether rises come in one part of the period, or in three, more than by chance.
bool FlickerPeriod::is_in_step(double period_us, double excess, double least) const noexcept {
    const double stretches = ticks() / double(kTicksABlock);
    // n phases at random give .9 sqrt(n) or less in a stretch, .5 sqrt(n) about the sum of all.
    const double chance = .9 * std::sqrt(counted_ * stretches) + 2.5 * std::sqrt(counted_);
    constexpr double kOfThree = .5;  // what is left of so much narrower a part
    return in_phase(period_us, 1) >= std::max(least * excess, chance) ||
           in_phase(period_us, 3) >= std::max(kOfThree * least * excess, chance);
}

/// 0 where there is none.
double FlickerPeriod::period_of_block() const noexcept {
    const Cumulative before = cumulative();
    Comb best;
    double found = 0;
    const auto look_at = [&](double period) {
        const bool known = is_as_before(period, state_.period_us);
        const Comb tried = comb(before, period);
        if (!is_periodic(tried, known ? kContrastAsBefore : kContrast)) return;
        if (tried.excess <= best.excess) return;
        if (!is_in_step(period, tried.excess, known ? kInStepAsBefore : kInStep)) return;
        best = tried;
        found = period;
    };
    double next = kShortestUs;
    while (next <= kLongestUs) {
        look_at(next);
        next *= kStep;
    }
    double period = found;
    for (int i = 0; period > 0 && i < 3; ++i) period = refined(period);
    return is_in_range(period) ? period : 0;
}

/// A period counts once two blocks in a row agree: what passes a few times leaves equal intervals,
/// too.
void FlickerPeriod::end_block() noexcept {
    if (counted_ < kEnough) {  // goes on in the next
        if (++state_.unsaid < kMostUnsaid) return;
        state_.period_us = state_.found_us = 0;
    } else {
        const double found = period_of_block();
        const bool agrees = is_as_before(found, state_.found_us);
        state_.period_us = found > 0 && agrees ? found : 0;
        state_.found_us = found;
    }
    state_.unsaid = 0;
    clear_intervals();
}

}  // namespace eventide
