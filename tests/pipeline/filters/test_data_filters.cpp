// The filters that users chain, each by events made to show what it does.
#include "pipeline/filters/filter_chain.h"
#include "src/core/bayer.h"
#include "src/core/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace eventide {
namespace {

using testing::HasSubstr;

constexpr SensorPixels kSensor{64, 48};

std::vector<Event> random_events(std::size_t n) {
    std::mt19937 random(7);
    std::vector<Event> events;
    std::int64_t t = 1'000'000;
    for (std::size_t i = 0; i < n; ++i)
        events.push_back({from_us(t += random() % 200), std::uint16_t(random() % 64),
                          std::uint16_t(random() % 48), Polarity(random() % 2)});
    return events;
}

Batch filtered(const std::vector<std::string>& filters, Batch batch) {
    FilterChain chain(filters, kSensor);
    chain.process(batch);
    return batch;
}

std::vector<Event> filtered(const std::vector<std::string>& filters,
                            const std::vector<Event>& events) {
    Batch batch;
    batch.events = events;
    return filtered(filters, std::move(batch)).events;
}

template <typename Keeps>
std::vector<Event> only(std::vector<Event> events, Keeps keeps) {
    std::erase_if(events, [&](const Event& event) { return !keeps(event); });
    return events;
}

Event at(std::int64_t us, int x, int y, Polarity polarity = Polarity::on) {
    return {from_us(us), std::uint16_t(x), std::uint16_t(y), polarity};
}

/// Value 1000 y + x, so that a pixel tells where it was.
ReferenceImage numbered_image(int width, int height) {
    ReferenceImage image;
    image.pixels = Array2<std::uint16_t>(height, width);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image.pixels(y, x) = std::uint16_t(1000 * y + x);
    return image;
}

TEST(DataFilters, RegionKeepsWhatLiesInIt) {
    const auto events = random_events(5'000);
    const auto expected =
        only(events, [](const Event& e) { return e.x >= 10 && e.x < 30 && e.y >= 5 && e.y < 15; });
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(filtered({"region:10,5,20x10"}, events), expected);
    EXPECT_EQ(filtered({"region:0,0,64x48"}, events), events);
}

TEST(DataFilters, PolarityKeepsOneKind) {
    const auto events = random_events(1'000);
    EXPECT_EQ(filtered({"polarity:off"}, events),
              only(events, [](const Event& e) { return e.polarity == Polarity::off; }));
    EXPECT_TRUE(filtered({"polarity:off", "polarity:on"}, events).empty());
}

TEST(DataFilters, SubsampleKeepsEachNthEventOrPixel) {
    const auto events = random_events(1'000);
    const auto third = filtered({"subsample:3"}, events);
    ASSERT_EQ(third.size(), 334U);
    for (std::size_t i = 0; i < third.size(); ++i) EXPECT_EQ(third[i], events[3 * i]);

    FilterChain chain({"subsample:2x3"}, kSensor);
    EXPECT_EQ(chain.size(), (SensorPixels{32, 16}));
    Batch batch;
    batch.events = {at(1, 4, 6), at(2, 5, 6), at(3, 4, 7), at(4, 63, 45), at(5, 62, 45)};
    batch.images = {numbered_image(64, 48)};
    chain.process(batch);
    EXPECT_EQ(batch.events, (std::vector<Event>{at(1, 2, 2), at(5, 31, 15)}));
    EXPECT_EQ(batch.images[0].pixels.width(), 32);
    EXPECT_EQ(batch.images[0].pixels.height(), 16);
    EXPECT_EQ(batch.images[0].pixels(2, 5), 1000 * 6 + 10);
}

TEST(DataFilters, RefractoryLeavesOutWhatComesTooSoonAtThatPixel) {
    const std::vector<Event> events{at(0, 1, 1),     at(500, 1, 1),   at(600, 2, 1),
                                    at(1'000, 1, 1), at(1'999, 1, 1), at(2'000, 1, 1)};
    EXPECT_EQ(filtered({"refractory:1ms"}, events),
              (std::vector<Event>{events[0], events[2], events[3], events[5]}));
}

TEST(DataFilters, BackgroundActivityAsksForNeighboursInSpaceAndTime) {
    const std::vector<Event> events{at(0, 10, 10),        // alone
                                    at(5'000, 11, 11),    // beside it, in time
                                    at(5'100, 13, 13),    // two pixels off
                                    at(30'000, 12, 12),   // too late for all
                                    at(30'100, 12, 12)};  // a pixel does not support itself
    EXPECT_EQ(filtered({"background-activity:10ms"}, events), (std::vector<Event>{events[1]}));
    EXPECT_EQ(filtered({"background-activity:10ms,2"}, events),
              (std::vector<Event>{events[1], events[2]}));
    EXPECT_EQ(filtered({"background-activity:40ms,1,2"}, events),
              (std::vector<Event>{events[3], events[4]}));
}

TEST(DataFilters, HotPixelsAreLearnt) {
    std::vector<Event> events;
    for (int i = 0; i < 2'000; ++i) events.push_back(at(1'000 * i, 20, 20));
    const auto left = filtered({"hot-pixels:learn"}, events);
    EXPECT_LT(left.size(), 600U);
    EXPECT_GT(left.size(), 100U);
}

TEST(DataFilters, FlipAndTransposeMoveEventsAndImagesAlike) {
    Batch batch;
    batch.events = {at(1, 3, 7)};
    batch.images = {numbered_image(64, 48)};
    const auto pixel_of_event = [](const Batch& b) {
        return b.images[0].pixels(b.events[0].y, b.events[0].x);
    };
    for (const char* filter : {"flip:x", "flip:y", "transpose"}) {
        const Batch moved = filtered({filter}, batch);
        EXPECT_NE(moved.events, batch.events) << filter;
        EXPECT_EQ(pixel_of_event(moved), 7'003) << filter;
        const Batch back = filtered({filter, filter}, batch);
        EXPECT_EQ(back.events, batch.events) << filter;
        EXPECT_TRUE(back.images == batch.images) << filter;
    }
    EXPECT_EQ(filtered({"flip:x"}, batch).events[0], at(1, 60, 7));
    EXPECT_EQ(FilterChain({"transpose"}, kSensor).size(), (SensorPixels{48, 64}));
    EXPECT_EQ(FilterChain({"transpose", "subsample:2x2"}, kSensor).size(), (SensorPixels{24, 32}));
}

/// What a sensor with that filter would send of a part of a scene that shows each colour as its
/// number.
ReferenceImage mosaic(ColourFilter filter, int x0, int y0, int width, int height) {
    ReferenceImage image = numbered_image(width, height);
    image.x0 = x0;
    image.y0 = y0;
    image.filter = filter;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.pixels(y, x) = std::uint16_t(channel_at(filter, x0 + x, y0 + y));
    return image;
}

/// As many pixels of `image` see another colour than its filter says.
int wrong_colours(const ReferenceImage& image) {
    int wrong = 0;
    for (int y = 0; y < image.pixels.height(); ++y)
        for (int x = 0; x < image.pixels.width(); ++x)
            wrong += image.pixels(y, x) !=
                     std::uint16_t(channel_at(image.filter, image.x0 + x, image.y0 + y));
    return wrong;
}

TEST(DataFilters, WhatMovesPixelsSaysTheirColoursAnew) {
    using enum ColourFilter;
    const std::vector<std::vector<std::string>> chains{
        {"region:3,5,20x20"}, {"flip:x"},        {"flip:y"},
        {"transpose"},        {"subsample:3x5"}, {"flip:x", "transpose", "flip:y"}};
    for (const SensorPixels& size : {SensorPixels{64, 48}, SensorPixels{63, 48}})
        for (const ColourFilter before : {rggb, grbg, gbrg, bggr})
            for (const auto& texts : chains) {
                FilterChain chain(texts, size);
                Batch batch;
                batch.images = {mosaic(before, 0, 0, size.width, size.height),
                                mosaic(before, 5, 2, 21, 30)};
                ASSERT_EQ(wrong_colours(batch.images[1]), 0);
                chain.process(batch);
                for (const ReferenceImage& image : batch.images) {
                    EXPECT_EQ(image.filter, chain.pattern(before)) << texts.back();
                    EXPECT_EQ(wrong_colours(image), 0) << texts.back() << " " << size.width;
                }
            }
    EXPECT_EQ(FilterChain({"flip:x"}, {64, 48}).pattern(rggb), grbg);
    EXPECT_EQ(FilterChain({"flip:y"}, {64, 48}).pattern(rggb), gbrg);
    EXPECT_EQ(FilterChain({"flip:x"}, {63, 48}).pattern(rggb), rggb);
    EXPECT_EQ(FilterChain({"transpose"}, kSensor).pattern(grbg), gbrg);
    for (const char* none_left : {"subsample:2x2", "subsample:2x1", "subsample:1x4"})
        EXPECT_EQ(FilterChain({none_left}, kSensor).pattern(rggb), none) << none_left;
    EXPECT_EQ(FilterChain({"flip:x"}, kSensor).pattern(none), none);
}

TEST(DataFilters, TimeKeepsAllKindsOfDataBetweenItsEnds) {
    Batch batch;
    for (int i = 0; i < 10; ++i) batch.events.push_back(at(5'000'000 + 1'000 * i, 1, 1));
    for (const int us : {5'000'000, 5'004'000, 5'009'000}) {
        batch.images.push_back(numbered_image(2, 2));
        batch.images.back().t = from_us(us);
        batch.triggers.push_back({from_us(us), Trigger::Kind::rising, 0});
    }
    const Batch middle = filtered({"time:3ms..6ms"}, batch);
    EXPECT_EQ(middle.events.size(), 4U);
    EXPECT_EQ(middle.images.size(), 1U);
    EXPECT_EQ(middle.triggers.size(), 1U);
    EXPECT_EQ(filtered({"time:@5003000..@5006000"}, batch).events, middle.events);
    EXPECT_EQ(filtered({"time:8ms.."}, batch).events.size(), 2U);
    EXPECT_EQ(filtered({"time:..2ms"}, batch).events.size(), 3U);
}

TEST(DataFilters, GoInTheOrderGiven) {
    const auto events = random_events(2'000);
    EXPECT_NE(filtered({"region:0,0,10x48", "flip:x"}, events),
              filtered({"flip:x", "region:0,0,10x48"}, events));
    EXPECT_EQ(filtered({"flip:x", "region:54,0,10x48"}, events),
              filtered({"region:0,0,10x48", "flip:x"}, events));
}

TEST(DataFilters, DoNotDependOnHowEventsAreSplit) {
    const auto events = random_events(5'000);
    const std::vector<std::string> all{
        "region:2,2,60x44", "refractory:2ms",  "background-activity:5ms,2",
        "subsample:2",      "flicker:1..200",  "flip:y",
        "transpose",        "time:20ms..400ms"};
    const auto whole = filtered(all, events);
    ASSERT_GT(whole.size(), 50U);
    FilterChain chain(all, kSensor);
    std::vector<Event> apart;
    for (std::size_t i = 0; i < events.size(); i += 13) {
        Batch batch;
        batch.events.assign(events.begin() + std::ptrdiff_t(i),
                            events.begin() + std::ptrdiff_t(std::min(i + 13, events.size())));
        chain.process(batch);
        apart.insert(apart.end(), batch.events.begin(), batch.events.end());
    }
    EXPECT_EQ(apart, whole);
    EXPECT_EQ(chain.left_out(), events.size() - whole.size());
    EXPECT_THAT(chain.report(), HasSubstr("flip:y 0"));
}

TEST(DataFilters, WrongWordsAreRefusedWithWhatIsExpected) {
    const auto refusal = [](const std::string& text) -> std::string {
        try {
            FilterChain({text}, kSensor);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            return error.what();
        }
        return "nothing was refused";
    };
    EXPECT_THAT(refusal("blur:3"), HasSubstr("expected one of region:X,Y,WxH, polarity:on|off"));
    EXPECT_THAT(refusal("region:1,2,3"), HasSubstr("10,20,100x50"));
    EXPECT_THAT(refusal("region:64,0,2x2"), HasSubstr("on the sensor of 64x48"));
    EXPECT_THAT(refusal("polarity:both"), HasSubstr("expected on or off, found 'both'"));
    EXPECT_THAT(refusal("subsample:0"), HasSubstr("N-th event"));
    EXPECT_THAT(refusal("subsample:2x99"), HasSubstr("no more than the sensor has"));
    EXPECT_THAT(refusal("refractory:5"), HasSubstr("such as 1ms"));
    EXPECT_THAT(refusal("background-activity:1ms,9"), HasSubstr("radius of 1 to 8"));
    EXPECT_THAT(refusal("background-activity:1ms,1,9"), HasSubstr("how many pixels"));
    for (const char* wrong :
         {"50", "50..", "..500", "500..50", "50..50", "0..50", "50..10001", "50hz..500hz"})
        EXPECT_THAT(refusal(std::string("flicker:") + wrong), HasSubstr("in Hz, such as 80..130"));
    EXPECT_THAT(refusal("flip:z"), HasSubstr("upside down"));
    EXPECT_THAT(refusal("transpose:x"), HasSubstr("nothing behind its name"));
    EXPECT_THAT(refusal("time:1s"), HasSubstr("FROM..TO"));
    EXPECT_THAT(refusal("hot-pixels:/no/such"), HasSubstr("/no/such"));
}

TEST(DataFilters, TimesCountFromTheRecordingsFirstEventInAnyOrder) {
    const auto events = random_events(2'000);
    EXPECT_EQ(filtered({"region:0,0,9x9", "time:40ms..120ms"}, events),
              filtered({"time:40ms..120ms", "region:0,0,9x9"}, events));
}

TEST(DataFilters, ImagesStayAmongTheEventsThatTheyCameAmong) {
    Batch batch;
    for (int t = 1; t <= 6; ++t) {
        batch.events.push_back(at(t, t, 0, t % 2 == 0 ? Polarity::on : Polarity::off));
        if (t % 3 == 0) batch.add_image(numbered_image(64, 48));
    }
    const Batch left = filtered({"polarity:on", "region:1,0,5x1"}, batch);
    EXPECT_EQ(left.events.size(), 2U);
    ASSERT_EQ(left.images.size(), 2U);
    EXPECT_EQ(left.place_of_image(0), 1U);
    EXPECT_EQ(left.place_of_image(1), 2U);
}

}  // namespace
}  // namespace eventide
