// Whether images and events of a stream are told by one clock.
#include "src/core/image_clock.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

constexpr std::int64_t kSecond = 1'000'000, kSince1970 = 1'633'953'690 * kSecond;

Batch image_at(std::int64_t t_us) {
    Batch batch;
    ReferenceImage image;
    image.t = from_us(t_us);
    batch.add_image(image);
    return batch;
}

Batch events_at(std::int64_t t_us) {
    Batch batch;
    batch.events = {{from_us(t_us), 1, 2, Polarity::on}, {from_us(t_us + 5), 1, 2, Polarity::off}};
    return batch;
}

SensorDuration apart(const std::vector<Batch>& stream) {
    ImageClock clock;
    for (const Batch& batch : stream) clock.see(batch);
    return clock.apart();
}

TEST(ImageClock, IsThatOfEventsNearAnyImage) {
    EXPECT_EQ(apart({events_at(0), image_at(10), events_at(20)}), SensorDuration{0});
    EXPECT_EQ(apart({image_at(0), events_at(30 * kSecond)}), SensorDuration{0});
    EXPECT_EQ(apart({events_at(0), image_at(30 * kSecond)}), SensorDuration{0});
}

TEST(ImageClock, IsAnotherWhereNoImageIsNearAnEvent) {
    EXPECT_EQ(apart({events_at(0), image_at(kSince1970), events_at(20)}),
              SensorDuration{kSince1970 - 25});
    EXPECT_EQ(apart({image_at(0), image_at(100), events_at(kSince1970)}),
              SensorDuration{kSince1970 - 95});
    EXPECT_EQ(apart({events_at(0), events_at(kSecond), image_at(kSince1970)}),
              SensorDuration{kSince1970 - kSecond - 5})
        << "images behind all events, as they come of a folder";
}

TEST(ImageClock, IsAnotherFromAMinuteOnUntilAnEventComesBesideAnImage) {
    EXPECT_EQ(apart({events_at(0), image_at(60 * kSecond)}), SensorDuration{0});
    EXPECT_EQ(apart({events_at(0), image_at(61 * kSecond)}), SensorDuration{61 * kSecond - 5});
    EXPECT_EQ(apart({events_at(0), image_at(61 * kSecond), events_at(61 * kSecond)}),
              SensorDuration{0});
}

TEST(ImageClock, IsNotKnownWithoutImagesAndEvents) {
    EXPECT_EQ(apart({events_at(0), events_at(kSince1970)}), SensorDuration{0});
    EXPECT_EQ(apart({image_at(0), image_at(kSince1970)}), SensorDuration{0});
}

TEST(ImageClock, StaysTheSameThroughAPauseOfDays) {
    constexpr std::int64_t kDays = 200'000 * kSecond;
    EXPECT_EQ(apart({events_at(0), image_at(10), image_at(kDays), events_at(kDays + 10)}),
              SensorDuration{0});
    EXPECT_EQ(apart({events_at(0), image_at(kDays), events_at(kDays + 10)}), SensorDuration{0})
        << "it was one all along";
    EXPECT_EQ(apart({events_at(0), image_at(10), image_at(kDays)}), SensorDuration{0})
        << "known once and for all";
}

TEST(ImageClock, IsThatOfTheEventsBehindTheLastOfSeveralImages) {
    Batch images = image_at(0);
    images.images.push_back(image_at(100 * kSecond).images.front());
    EXPECT_EQ(apart({images, events_at(101 * kSecond)}), SensorDuration{0});
}

}  // namespace
}  // namespace eventide
