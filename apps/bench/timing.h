// Milliseconds of repeated work: in processor time, which a busy machine changes little, and by the
// clock on the wall.
#pragma once

#include <functional>
#include <vector>

namespace eventide::bench {

/// What many repetitions gave: median, the quartiles beside it, and the least.
struct Spread {
    double median = 0, low = 0, high = 0, least = 0;
};

/// All 0 where there are no values.
Spread spread_of(std::vector<double> values);

struct Timing {
    Spread cpu_ms;   ///< processor time of the whole process, all its threads
    Spread wall_ms;  ///< as a clock shows it
};

/// Collects one repetition after the other.
class Stopwatch {
public:
    void start();
    void stop();
    Timing timing() const { return {spread_of(cpu_ms_), spread_of(wall_ms_)}; }
    const std::vector<double>& cpu_ms() const { return cpu_ms_; }

private:
    double cpu_ = 0, wall_ = 0;
    std::vector<double> cpu_ms_, wall_ms_;
};

/// body(i) so many times, after a few that are not counted.
Timing timed(int repetitions, const std::function<void(int)>& body);

}  // namespace eventide::bench
