// Images of one folder against those of another.
#include "apps/evaluate/evaluate.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/support/error_of.h"

#include <gtest/gtest.h>

namespace eventide::test {
namespace {

TEST(EvaluateFolders, FindNothingBetweenEqualFolders) {
    const fs::path folder = fresh_folder("folders");
    for (const char* side : {"frames", "references"})
        for (const char* sequence : {"one", "two"}) {
            fs::create_directories(folder / side / sequence);
            for (int i = 0; i < 3; ++i)
                write_image(folder / side / sequence / (std::to_string(i) + ".png"),
                            test_image(kHeight, kWidth, i));
        }
    const EvaluateReport report = evaluate_folders(folder / "frames", folder / "references", {});
    EXPECT_EQ(report.overall.frames, 6);
    EXPECT_EQ(report.overall.raw.mse, 0);
    EXPECT_NEAR(report.overall.raw.ssim, 1, 1e-9);
    EXPECT_FALSE(report.overall.picp80);
    EXPECT_EQ(
        evaluate_folders(folder / "frames/one/", folder / "references/one/", {}).overall.sequence,
        "one");

    cv::Mat deep;
    cv::imread((folder / "references/one/0.png").string(), cv::IMREAD_GRAYSCALE)
        .convertTo(deep, CV_16U, 257);
    cv::imwrite((folder / "frames/one/0.png").string(), deep);
    EXPECT_LT(
        evaluate_folders(folder / "frames/one", folder / "references/one", {}).overall.raw.mse,
        1e-12)
        << "16 bits are as white as 8";
    write_image(folder / "frames" / "one" / "9.png", test_image(kHeight, kWidth, 9));
    EXPECT_THROW(evaluate_folders(folder / "frames", folder / "references", {}), Error);
}

TEST(EvaluateFolders, LeaveOutNoSequenceInSilence) {
    const fs::path folder = fresh_folder("unequal");
    for (const char* sequence :
         {"frames/one", "references/one", "references/two", "frames/nothing", "references/nothing"})
        fs::create_directories(folder / sequence);
    for (const char* image : {"frames/one/0.png", "references/one/0.png", "references/two/0.png"})
        write_image(folder / image, test_image(kHeight, kWidth, 0));
    std::vector<std::string> warnings;
    const auto evaluate = [&] {
        return evaluate_folders(folder / "frames", folder / "references", {},
                                [&](const std::string& text) { warnings.push_back(text); });
    };
    EXPECT_EQ(evaluate().overall.frames, 1);
    EXPECT_EQ(warnings, std::vector<std::string>{(folder / "references/two").string() +
                                                 ": is left out, as there is no folder " +
                                                 (folder / "frames/two").string()});
    for (const char* alone : {"frames/three", "frames/no_images"})
        fs::create_directory(folder / alone);
    write_image(folder / "frames/three/0.png", test_image(kHeight, kWidth, 0));
    warnings.clear();
    EXPECT_EQ(evaluate().overall.frames, 1);
    EXPECT_EQ(warnings,
              (std::vector<std::string>{
                  (folder / "frames/three").string() + ": is left out, as there is no folder " +
                      (folder / "references/three").string(),
                  (folder / "references/two").string() + ": is left out, as there is no folder " +
                      (folder / "frames/two").string()}));
    write_image(folder / "references/0.png", test_image(kHeight, kWidth, 0));
    EXPECT_EQ(evaluate().overall.frames, 1);
    EXPECT_EQ(warnings.back(), (folder / "references").string() +
                                   ": 1 image beside its folders left out, as " +
                                   (folder / "frames").string() + " has folders alone");
    fs::create_directory(folder / "frames/two");
    EXPECT_EQ(error_of(evaluate, ErrorKind::input),
              "two: expected as many images as references, found 0 and 1");
}

TEST(EvaluateFolders, CompareImagesInTheOrderOfTheirNames) {
    const fs::path folder = fresh_folder("order");
    const auto write = [&](const char* side, const char* sequence, int i) {
        fs::create_directories(folder / side / sequence);
        const std::string name = std::string{side} + std::to_string(100 + i) + ".png";
        write_image(folder / side / sequence / name, test_image(kHeight, kWidth, i));
    };
    for (int i = 0; i < 20; ++i) write("frames", "b", i);
    for (int i = 19; i >= 0; --i) write("references", "b", i);
    for (const char* sequence : {"d", "a", "c"})
        for (const char* side : {"frames", "references"}) write(side, sequence, 1);
    const EvaluateReport report = evaluate_folders(folder / "frames", folder / "references", {});
    std::vector<std::string> names;
    for (const SequenceReport& sequence : report.sequences)
        names.push_back(sequence.scores.sequence);
    EXPECT_EQ(names, (std::vector<std::string>{"a", "b", "c", "d"}));
    EXPECT_EQ(report.overall.raw.mse, 0);
}

TEST(EvaluateFolders, TakeImagesWhoseExtensionIsInCapitals) {
    const fs::path folder = fresh_folder("capitals");
    for (const char* side : {"frames", "references"}) {
        fs::create_directories(folder / side);
        for (const char* name : {"0.PNG", "1.png"})
            write_image(folder / side / name, test_image(kHeight, kWidth, 1));
    }
    EXPECT_EQ(evaluate_folders(folder / "frames", folder / "references", {}).overall.frames, 2);
}

TEST(EvaluateFolders, NameTheImagesThatCannotBeCompared) {
    const fs::path folder = fresh_folder("sizes");
    for (const char* side : {"frames", "references"}) fs::create_directories(folder / side);
    write_image(folder / "frames/a.png", test_image(kHeight, kWidth, 1));
    write_image(folder / "references/b.png", test_image(kHeight, kWidth + 2, 1));
    try {
        evaluate_folders(folder / "frames", folder / "references", {});
        FAIL() << "images of two sizes";
    } catch (const Error& error) {
        EXPECT_EQ(std::string{error.what()}.find((folder / "frames/a.png").string() + " against " +
                                                 (folder / "references/b.png").string() + ": "),
                  0U)
            << error.what();
    }
}

}  // namespace
}  // namespace eventide::test
