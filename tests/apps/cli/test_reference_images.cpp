// The sensor's own images, kept for whoever shows the truth beside a frame.
#include "apps/cli/run/reference_images.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace eventide::app {
namespace {

/// An image of one grey in each millisecond, that of its number.
void show_images(ReferenceImages& references, int from_ms, int to_ms) {
    for (int ms = from_ms; ms < to_ms; ++ms) {
        Batch batch;
        ReferenceImage& image = batch.images.emplace_back();
        image.t = from_us(1000 * ms);
        image.pixels = Array2<std::uint16_t>(2, 3);
        for (std::uint16_t& pixel : image.pixels.values()) pixel = std::uint16_t(257 * (ms % 256));
        references.see(batch);
    }
}

/// Empty where there is none.
cv::Mat truth_at(const ReferenceImages& references, int ms) {
    cv::Mat shown;
    const SensorTime t = from_us(1000 * ms);
    references.draw_nearest(t, {t - SensorDuration{1000}, t}, {3, 2}, ReferenceImages::Shows::grey,
                            shown);
    return shown;
}

TEST(ReferenceImages, AreThereForAsLongAsTheContactSheetWaitsHoweverManyThereAre) {
    ReferenceImages references;
    show_images(references, 0, 3000);
    const int early = 3000 - int((kTruthDelay + SensorDuration{400'000}).count() / 1000);
    const cv::Mat shown = truth_at(references, early);
    ASSERT_FALSE(shown.empty());
    EXPECT_EQ(shown.at<std::uint8_t>(1, 2), early % 256);
    EXPECT_TRUE(truth_at(references, 100).empty()) << "they do not grow without end";
}

TEST(ReferenceImages, TheNewestFewStayHoweverFarApart) {
    constexpr int kApartMs = 10'000, kFew = int(ReferenceImages::kKeptAnyway);
    ReferenceImages references;
    for (int i = 0; i < kFew; ++i) show_images(references, i * kApartMs, i * kApartMs + 1);
    EXPECT_FALSE(truth_at(references, 0).empty());
    show_images(references, kFew * kApartMs, kFew * kApartMs + 1);
    EXPECT_TRUE(truth_at(references, 0).empty());
    EXPECT_FALSE(truth_at(references, kApartMs).empty());
}

TEST(ReferenceImages, OfAClockThatBeganAnewAreTheNewOnes) {
    ReferenceImages references;
    show_images(references, 10'000, 10'100);
    show_images(references, 0, 100);
    EXPECT_TRUE(truth_at(references, 10'010).empty());
    EXPECT_FALSE(truth_at(references, 10).empty());
}

TEST(ReferenceImages, AreInColourWhereThatIsAskedForAndTheyAre) {
    using Shows = ReferenceImages::Shows;
    for (const int channels : {1, 3, 4}) {
        ReferenceImages references;
        Batch batch;
        ReferenceImage& image = batch.images.emplace_back();
        image.channels = channels;
        image.pixels = Array2<std::uint16_t>(2, 3 * channels);
        for (int y = 0; y < 2; ++y)
            for (int x = 0; x < 3; ++x) image.pixels(y, channels * x) = 257 * 200;
        references.see(batch);
        cv::Mat grey, colours;
        references.draw_nearest({}, {}, {3, 2}, Shows::grey, grey);
        references.draw_nearest({}, {}, {3, 2}, Shows::colours, colours);
        EXPECT_EQ(grey.type(), CV_8UC1);
        if (channels == 1) {
            EXPECT_EQ(colours.type(), CV_8UC1);
            EXPECT_EQ(colours.at<std::uint8_t>(1, 2), 200);
            continue;
        }
        EXPECT_EQ(grey.at<std::uint8_t>(1, 2), 23) << "blue weighs little";
        EXPECT_EQ(colours.at<cv::Vec3b>(1, 2), cv::Vec3b(200, 0, 0)) << channels;
    }
}

TEST(ReferenceImages, OneBesideTheSensorShowsNothingOfIt) {
    ReferenceImages references;
    Batch batch;
    ReferenceImage& image = batch.images.emplace_back();
    image.pixels = Array2<std::uint16_t>(2, 3);
    std::ranges::fill(image.pixels.values(), std::uint16_t{65535});
    image.x0 = 40;
    references.see(batch);
    const cv::Mat shown = truth_at(references, 0);
    EXPECT_EQ(shown.size(), cv::Size(3, 2));
    EXPECT_EQ(cv::countNonZero(shown), 0);
}

}  // namespace
}  // namespace eventide::app
