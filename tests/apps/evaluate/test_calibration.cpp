// One factor for sigma, found on held-out data and kept in the model.
#include "apps/evaluate/evaluate.h"
#include "src/core/error.h"
#include "src/model/model_file.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/apps/evaluate/small_model.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace eventide::test {
namespace {

TEST(Calibration, BringsTheCoverageToEightTenthsAndIsWrittenIntoTheModel) {
    const fs::path folder = write_recording(fresh_folder("calibration"), .9, .001, .1);
    RecordingSettings what;
    what.recordings = {folder};
    EvaluateSettings how = small_model();
    const SigmaCalibration found =
        calibrate(evaluate_recordings(what, how), CalibrationRule::coverage);
    EXPECT_NEAR(found.picp80_after, .8, .01);
    const fs::path calibrated = fs::path{testing::TempDir()} / "eventide_calibrated.safetensors";
    write_calibrated(how.model, calibrated, found, true);
    how.model = calibrated;
    const EvaluateReport after = evaluate_recordings(what, how);
    EXPECT_NEAR(*after.overall.picp80, .8, .02);
    EXPECT_NEAR(*after.overall.ll, found.ll_after, .02);
    EXPECT_NE(load_model(calibrated).config.card.find("calibrated"), std::string::npos);
}

TEST(Calibration, GoesOnFromTheFactorThatTheModelHas) {
    RecordingSettings what;
    what.recordings = {write_recording(fresh_folder("calibrated_twice"), .9, .001, .1)};
    EvaluateSettings how = small_model();
    const auto calibrated = [&](const char* name) {
        const SigmaCalibration found =
            calibrate(evaluate_recordings(what, how), CalibrationRule::coverage);
        const fs::path to = fresh_folder(std::string("calibrated_") + name) / "model.safetensors";
        write_calibrated(how.model, to, found, true);
        how.model = to;
        return found;
    };
    const SigmaCalibration first = calibrated("first");
    EXPECT_GT(std::abs(first.picp80_before - .8), .05);
    EXPECT_NE(first.ll_before, first.ll_after);
    const SigmaCalibration second = calibrated("second");
    EXPECT_NEAR(second.factor, 1, .02) << "of what is calibrated";
    EXPECT_NEAR(second.picp80_before, .8, .02);
    EXPECT_NEAR(load_model(how.model).config.sigma_scale, first.factor * second.factor, 1e-3);
}

TEST(Calibration, CautiouslyLeavesOutSequencesWithoutSigma) {
    EvaluateReport report;
    SequenceReport known;
    Array2<float> mu(12, 12), sigma(12, 12), truth(12, 12);
    std::ranges::fill(mu.values(), .5F);
    std::ranges::fill(sigma.values(), .4F);
    std::ranges::fill(truth.values(), .6F);
    known.sigma_scale.add(mu, sigma, truth);
    report.observations.sigma_scale = known.sigma_scale;
    report.sequences = {known, SequenceReport{}};
    EXPECT_NEAR(calibrate(report, CalibrationRule::cautious).factor, .25 / 1.2816, .01);
}

TEST(Calibration, IsWrittenWithTheRuleItHoldsFor) {
    RecordingSettings what;
    what.recordings = {write_recording(fresh_folder("calibration_rule"), .9, .001, .1)};
    EvaluateSettings how = small_model();
    how.sigma_rule = SigmaRule::mixture;
    how.lookahead = 1;  // of one latent map the rules say the same
    SigmaCalibration found = calibrate(evaluate_recordings(what, how), CalibrationRule::coverage);
    found.sigma_rule = how.sigma_rule;
    const fs::path calibrated = fresh_folder("calibrated_rule") / "model.safetensors";
    write_calibrated(how.model, calibrated, found);
    EXPECT_EQ(load_model(calibrated).config.sigma_rule, SigmaRule::mixture);
    how.model = calibrated;
    how.sigma_rule.reset();
    EXPECT_NEAR(*evaluate_recordings(what, how).overall.ll, found.ll_after, .02);
}

TEST(Calibration, CautiouslyHoldsInEverySequence) {
    const fs::path folder = fresh_folder("cautious");
    RecordingSettings what;
    what.recordings = {write_recording(folder / "a", .4, .002, .1),
                       write_recording(folder / "b", .9, .002, .3)};
    what.skip_images = 0;
    const EvaluateSettings how = small_model();
    EvaluateReport report = evaluate_recordings(what, how);
    const double cautious = calibrate(report, CalibrationRule::cautious).factor;
    std::swap(report.sequences[0], report.sequences[1]);
    EXPECT_EQ(calibrate(report, CalibrationRule::cautious).factor, cautious) << "in any order";
    double largest = 0;
    for (const fs::path& one : what.recordings) {
        RecordingSettings alone = what;
        alone.recordings = {one};
        largest = std::max(
            largest, calibrate(evaluate_recordings(alone, how), CalibrationRule::coverage).factor);
    }
    EXPECT_EQ(cautious, largest);
    EXPECT_GE(cautious, calibrate(report, CalibrationRule::coverage).factor);
}

TEST(Calibration, ByLikelihoodIsNeverLessLikely) {
    const fs::path folder = write_recording(fresh_folder("likelihood"), .5, .001, .1);
    RecordingSettings what;
    what.recordings = {folder};
    const EvaluateReport report = evaluate_recordings(what, small_model());
    const SigmaCalibration found = calibrate(report, CalibrationRule::likelihood);
    EXPECT_GE(found.ll_after, found.ll_before);
    EXPECT_GE(found.ll_after, calibrate(report, CalibrationRule::coverage).ll_after);
    EXPECT_THROW(calibrate(EvaluateReport{}, CalibrationRule::coverage), Error);
}

}  // namespace
}  // namespace eventide::test
