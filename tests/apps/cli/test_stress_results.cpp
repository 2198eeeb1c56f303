// What a case of eventide stress makes of its numbers: nothing that failed is hidden by what comes
// after.
#include "apps/cli/stress/soak.h"
#include "apps/cli/stress/stress_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace eventide::stress {
namespace {

Distance between(const std::vector<float>& fast, const std::vector<double>& exact) {
    Distance distance;
    distance.add(fast, exact);
    return distance;
}

TEST(StressDistance, IsRelativeToTheLargestNumberOrOne) {
    EXPECT_NEAR(between({.5F, .25F}, {.5, .125}).worst, .125, 1e-12);
    EXPECT_NEAR(between({8, 3}, {8, 2}).worst, .125, 1e-12);
}

TEST(StressDistance, OfNumbersThatAreNoneIsNone) {
    for (const std::vector<float>& fast : {std::vector<float>{NAN, 1, 2}, {1, NAN, 2}, {1, 1, NAN}})
        EXPECT_TRUE(std::isnan(between(fast, {1, 1, 2}).worst));
    Distance both = between({NAN}, {1});
    both.add(between({1}, {1}));
    EXPECT_TRUE(std::isnan(both.worst));
    both.add(std::vector<float>{3}, std::vector<double>{1});
    EXPECT_TRUE(std::isnan(both.worst));
}

PipelineOutcome outcome_of(const Distance& codes, const Distance& frames) {
    PipelineOutcome outcome;
    outcome.codes = codes;
    outcome.frames = frames;
    outcome.counters.frames = 1;
    return outcome;
}

TEST(StressResult, FailsWhereCodesOrFramesAreFarFromDoublePrecision) {
    const Distance near = between({1}, {1}), far = between({1}, {.9}), none = between({NAN}, {1});
    EXPECT_TRUE(judged(outcome_of(near, near), "").passed);
    for (const Distance& bad : {far, none}) {
        EXPECT_FALSE(judged(outcome_of(bad, near), "").passed);
        EXPECT_FALSE(judged(outcome_of(near, bad), "").passed);
    }
}

Result result_of(bool passed, std::optional<double> error) {
    Result result;
    result.passed = passed;
    result.error = error;
    return result;
}

TEST(StressResult, OfTwoRunsIsTheOneThatFailedElseTheLargerError) {
    const Result good = result_of(true, .1), better = result_of(true, .01),
                 failed = result_of(false, {});
    EXPECT_EQ(&worse(good, better), &good);
    EXPECT_EQ(&worse(better, good), &good);
    EXPECT_EQ(&worse(failed, good), &failed);
    EXPECT_EQ(&worse(good, failed), &failed);
}

TEST(StressResult, OfASoakFailsForAStateThatWasNoNumberForAWhile) {
    std::vector<SoakSample> samples(12);
    for (SoakSample& sample : samples) {
        sample.resident_mib = 60;
        sample.latency_p99_ms = 10;
        sample.largest_state = .5;
    }
    EXPECT_TRUE(soak_verdict(samples).passed) << soak_verdict(samples).happened;
    samples[5].largest_state = NAN;
    EXPECT_FALSE(soak_verdict(samples).passed);
}

}  // namespace
}  // namespace eventide::stress
