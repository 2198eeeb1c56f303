// Of the simulated test set which frames count and which photographs it shows, as
// docs/accuracy.md says.
#include "apps/evaluate/scores.h"
#include "apps/evaluate/simulated_sequence.h"
#include "src/metrics/image_measures.h"
#include "tests/apps/evaluate/recordings.h"

#include <gtest/gtest.h>

#include <vector>

namespace eventide::test {
namespace {

TEST(SimulatedSet, ScoresEachFifthWindowFromTheNinthOn) {
    const SimulatedSettings what;
    std::vector<int> scored;
    for (int k = 0; k < what.event_windows; ++k)
        if (is_scored(what, k)) scored.push_back(k + 1);
    std::vector<int> expected;
    for (int window = 9; window <= 150; window += 5) expected.push_back(window);
    EXPECT_EQ(scored, expected);
}

TEST(SimulatedSet, ShowsTheLastImagesOfAFolderByName) {
    const fs::path folder = fresh_folder("photographs");
    for (int i = 0; i < 5; ++i)
        write_image(folder / ("image_" + std::to_string(i) + ".png"), test_image(20 + i, 30, i));
    SimulatedSettings what;
    what.images = folder;
    const auto heights = [&] {
        std::vector<int> all;
        const auto textures = test_textures(what);
        for (std::size_t i = 0; i < textures->size(); ++i) all.push_back((*textures)[i].height());
        return all;
    };
    EXPECT_EQ(heights(), (std::vector<int>{20, 21, 22, 23, 24}));
    what.last_images = 2;
    EXPECT_EQ(heights(), (std::vector<int>{23, 24}));
    what.last_images = 9;
    EXPECT_EQ(heights().size(), 5U);
}

TEST(Judge, CorrelatesPatchesOf16PixelsWithTheirMedianSigma) {
    const fs::path weights = shared_data() / "perceptual" / "lpips_squeeze_v0.1.npz";
    if (!fs::exists(weights)) GTEST_SKIP() << "no LPIPS weights: " << weights << " is absent";
    const Lpips lpips{weights};
    const Array2<float> frame = test_image(72, 90, 1), truth = test_image(72, 90, 2),
                        sigma = test_image(72, 90, 3);
    Judge judge{&lpips};
    const FrameScores scores = judge.judge(frame, sigma, truth);
    const auto map = lpips.distance_map(lpips.features(frame), lpips.features(truth));
    const auto errors = patch_means(map, 16), doubts = patch_medians(sigma, 16);
    ASSERT_EQ(errors.size(), 20U);  // 4 x 5
    EXPECT_NEAR(*scores.lpips_corr, *correlation(spread(errors, doubts)), 1e-9);
    EXPECT_NEAR(*scores.raw.lpips, lpips.distance(lpips.features(frame), lpips.features(truth)),
                1e-9);
    std::uint64_t patches = 0;
    for (const Observations::PatchBin& bin : judge.observations().patch_bins)
        patches += bin.patches;
    EXPECT_EQ(patches, 20U);
    EXPECT_EQ(judge.observations().patch_sizes.front().size, 8);
    EXPECT_EQ(judge.observations().patch_sizes.back().size, 96);
}

}  // namespace
}  // namespace eventide::test
