// A comb laid over the times between rises.
#include "src/binning/flicker_period.h"

#include "src/core/error.h"

#include <algorithm>
#include <cmath>
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
constexpr double kShare = .05;          // of all intervals, near whole numbers of periods
constexpr double kAsBefore = .03;       // of the period
constexpr int kMostUnsaid = 20;         // blocks that say nothing, until nothing is known
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
}

void FlickerPeriod::reset() noexcept {
    std::ranges::fill(state_.rises, 0U);
    state_.intervals.fill(0);
    counted_ = 0;
    state_.block.reset();
    state_.period_us = state_.found_us = 0;
    state_.unsaid = 0;
}

void FlickerPeriod::restore(const State& state) {
    if (state.rises.size() != state_.rises.size())
        throw Error(ErrorKind::input,
                    "flicker: expected what is known of " + std::to_string(state_.rises.size()) +
                        " pixels, found that of " + std::to_string(state.rises.size()));
    for (const double us : {state.period_us, state.found_us})
        if (us != 0 && !is_in_range(us))
            throw Error(ErrorKind::input, "flicker: expected a period of " +
                                              std::to_string(int(kShortestUs)) + " to " +
                                              std::to_string(int(kLongestUs)) + " us, found " +
                                              std::to_string(us));
    state_ = state;
    counted_ = std::accumulate(state.intervals.begin(), state.intervals.end(), std::uint32_t{0});
}

void FlickerPeriod::see(const Event& event) noexcept {
    if (((event.x + event.y) & 3) != 0) return;
    if (!state_.block || event.t < *state_.block) state_.block = event.t;
    if (event.t - *state_.block >= kBlock) {
        end_block();
        state_.block = event.t;
    }
    note(event);
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
    if (bin >= kBins) return;
    ++state_.intervals[bin];
    ++counted_;
}

FlickerPeriod::Sums FlickerPeriod::sums() const noexcept {
    Sums sums{};
    std::partial_sum(state_.intervals.begin(), state_.intervals.end(), sums.begin() + 1);
    return sums;
}

/// Of bins whose middle lies within.
FlickerPeriod::Comb FlickerPeriod::comb(const Sums& sums, double period_us) noexcept {
    double whole = 0, between = 0;
    int wholes = 0, betweens = 0;
    const auto add = [&](double from, double to, double& intervals, int& bins) {
        const auto edge = [&](double periods) {
            return std::clamp(int(std::ceil(periods * period_us / kBinUs - .5)), 0, kBins);
        };
        const int first = edge(from), end = edge(to);
        intervals += sums[std::size_t(end)] - sums[std::size_t(first)];
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

bool FlickerPeriod::is_flicker(const Comb& comb, double least) const noexcept {
    return comb.whole - comb.between >= least * (comb.whole + comb.between) &&
           comb.excess >= kShare * counted_;
}

/// 0 where there is none.
double FlickerPeriod::period_of_block() const noexcept {
    const Sums sums = this->sums();
    Comb best;
    double found = 0;
    const auto look_at = [&](double period) {
        const bool known = is_as_before(period, state_.period_us);
        const Comb tried = comb(sums, period);
        if (!is_flicker(tried, known ? kContrastAsBefore : kContrast)) return;
        if (tried.excess <= best.excess) return;
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
    state_.intervals.fill(0);
    counted_ = 0;
}

}  // namespace eventide
