// See timing.h.
#include "apps/bench/timing.h"

#include <algorithm>
#include <ctime>

namespace eventide::bench {
namespace {

constexpr int kWarm = 3;  // repetitions until caches and frequency are what they stay

double milliseconds(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return 1e3 * double(now.tv_sec) + 1e-6 * double(now.tv_nsec);
}

}  // namespace

Spread spread_of(std::vector<double> values) {
    if (values.empty()) return {};
    std::ranges::sort(values);
    const auto at = [&](double share) {
        const double place = share * double(values.size() - 1);
        const auto before = std::size_t(place);
        const auto after = std::min(before + 1, values.size() - 1);
        return values[before] + (place - double(before)) * (values[after] - values[before]);
    };
    return {at(.5), at(.25), at(.75), values.front()};
}

void Stopwatch::start() {
    wall_ = milliseconds(CLOCK_MONOTONIC);
    cpu_ = milliseconds(CLOCK_PROCESS_CPUTIME_ID);
}

void Stopwatch::stop() {
    cpu_ms_.push_back(milliseconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_);
    wall_ms_.push_back(milliseconds(CLOCK_MONOTONIC) - wall_);
}

Timing timed(int repetitions, const std::function<void(int)>& body) {
    for (int i = 0; i < kWarm; ++i) body(i);
    Stopwatch watch;
    for (int i = 0; i < repetitions; ++i) {
        watch.start();
        body(kWarm + i);
        watch.stop();
    }
    return watch.timing();
}

}  // namespace eventide::bench
