// What all cases share.
#include "apps/cli/stress/stress_case.h"

#include "apps/cli/stress/worst.h"

namespace eventide::stress {

Result judged(const PipelineOutcome& outcome, const std::string& happened, double bound) {
    Result result;
    result.happened = happened;
    const Distance& codes = outcome.codes;
    const Distance& frames = outcome.frames;
    if (codes.compared + frames.compared > 0) {
        result.error = worst_of(codes.worst, frames.worst);
        result.bound = bound;
        result.expect(*result.error <= bound, "near double precision");
        result.expect(frames.compared > 0, "frames were compared");
        result.expect(outcome.largest_state <= 1, "states within 1");
    }
    result.expect(outcome.error.empty(), "no error: " + outcome.error);
    result.expect(outcome.counters.frames > 0, "frames");
    return result;
}

const Result& worse(const Result& a, const Result& b) {
    if (a.passed != b.passed) return a.passed ? b : a;
    return a.passed && b.error > a.error ? b : a;
}

std::vector<Case> all_cases() {
    std::vector<Case> all;
    for (const auto& family : {activity_cases(), time_cases(), window_cases(), size_cases(),
                               number_cases(), agreement_cases(), resource_cases()})
        all.insert(all.end(), family.begin(), family.end());
    return all;
}

}  // namespace eventide::stress
