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
    references.draw_nearest(t, {t - SensorDuration{1000}, t}, {3, 2}, false, shown);
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
    constexpr int kApart_ms = 10'000, kFew = int(ReferenceImages::kKeptAnyway);
    ReferenceImages references;
    for (int i = 0; i < kFew; ++i) show_images(references, i * kApart_ms, i * kApart_ms + 1);
    EXPECT_FALSE(truth_at(references, 0).empty());
    show_images(references, kFew * kApart_ms, kFew * kApart_ms + 1);
    EXPECT_TRUE(truth_at(references, 0).empty());
    EXPECT_FALSE(truth_at(references, kApart_ms).empty());
}

TEST(ReferenceImages, OfAClockThatBeganAnewAreTheNewOnes) {
    ReferenceImages references;
    show_images(references, 10'000, 10'100);
    show_images(references, 0, 100);
    EXPECT_TRUE(truth_at(references, 10'010).empty());
    EXPECT_FALSE(truth_at(references, 10).empty());
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

TEST(ReferenceImages, AreInColourBesideFramesInColour) {
    for (const int channels : {3, 4}) {
        ReferenceImages references;
        Batch batch;
        ReferenceImage& image = batch.images.emplace_back();
        image.channels = channels;
        image.pixels = Array2<std::uint16_t>(2, 3 * channels);
        std::ranges::fill(image.pixels.row(0), std::uint16_t{0});
        image.pixels(0, 0) = 65535;  // blue
        references.see(batch);
        cv::Mat shown;
        references.draw_nearest(from_us(0), {}, {3, 2}, true, shown);
        ASSERT_EQ(shown.type(), CV_8UC3);
        EXPECT_EQ(shown.at<cv::Vec3b>(0, 0), cv::Vec3b(255, 0, 0));
        references.draw_nearest(from_us(0), {}, {3, 2}, false, shown);
        ASSERT_EQ(shown.type(), CV_8UC1);
        EXPECT_EQ(shown.at<std::uint8_t>(0, 0), 29) << "as bright as blue is";
    }
}

}  // namespace
}  // namespace eventide::app
