// Recordings with reference images, as they are read and cut into event windows.
#include "apps/evaluate/reference_sequence.h"
#include "pipeline/filters/event_filter.h"
#include "replay/formats.h"
#include "replay/recording_file.h"
#include "src/core/bayer.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/io/bag_writer.h"
#include "tests/support/flickering_light.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <optional>
#include <vector>

namespace eventide::test {
namespace {

TEST(ReferenceWindows, HoldEachEventBetweenTheImagesExactlyOnce) {
    const fs::path folder = write_recording(fresh_folder("slices"), .5, .001, .1);
    const ReferenceSequence sequence = read_reference_sequence(folder);
    EXPECT_EQ(sequence.width, kWidth);
    EXPECT_EQ(sequence.images.size(), 5U);
    std::vector<EventWindow> event_windows;
    for_each_reference_window(
        sequence, [&](const EventWindow& event_window) { event_windows.push_back(event_window); });
    ASSERT_EQ(event_windows.size(), 5U);
    EXPECT_TRUE(event_windows[0].events.empty());
    std::size_t events = 0;
    for (std::size_t i = 0; i < event_windows.size(); ++i) {
        EXPECT_EQ(event_windows[i].window.end, sequence.images[i].t);
        if (i > 0) {
            EXPECT_EQ(event_windows[i].window.begin, event_windows[i - 1].window.end);
        }
        for (const Event& event : event_windows[i].events) {
            EXPECT_GT(event.t, event_windows[i].window.begin);
            EXPECT_LE(event.t, event_windows[i].window.end);
        }
        events += event_windows[i].events.size();
    }
    EXPECT_EQ(events, 400U);  // (0, .4] s, one each millisecond
}

TEST(ReferenceSequence, IsCalledAsItsFolder) {
    const fs::path folder = write_recording(fresh_folder("at.5"), .5, .001, .1);
    EXPECT_EQ(read_reference_sequence(folder).name, "eventide_at.5");
    EXPECT_EQ(read_reference_sequence(folder / "").name, "eventide_at.5");
    EXPECT_EQ(sequence_name(folder / "."), "eventide_at.5");
    EXPECT_EQ(sequence_name("recordings/speed.5.aedat4"), "speed.5");
}

TEST(ReferenceSequence, CountsTimesFromItsFirstEventOrImage) {
    const fs::path folder = write_recording(fresh_folder("late_events"), .5, .001, .1);
    std::ofstream{folder / "events.txt"} << "0.15 1 2 1\n0.25 3 4 0\n0.35 3 4 1\n";
    const ReferenceSequence whole = read_reference_sequence(folder);
    EXPECT_EQ(whole.first, from_us(0));
    EXPECT_EQ(whole.images.size(), 5U);
    const ReferenceSequence part = read_reference_sequence(folder, .2, .3);
    EXPECT_EQ(part.first, from_us(0));
    ASSERT_EQ(part.images.size(), 2U);
    EXPECT_EQ(part.images[0].t, from_us(200'000));
    ASSERT_EQ(part.events.size(), 1U);
    EXPECT_EQ(part.events[0].t, from_us(250'000));
}

constexpr int kRed = 200 * 257, kOthers = 20 * 257;

/// A bag with one image of a sensor before which everything is red, which says its `encoding`.
fs::path colour_bag(const char* encoding) {
    ReferenceImage mosaic;
    mosaic.t = from_us(500);
    mosaic.pixels = Array2<std::uint16_t>(4, 6);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 6; ++x)
            mosaic.pixels(y, x) =
                channel_at(ColourFilter::grbg, x, y) == ColourChannel::red ? kRed : kOthers;
    const std::vector<Event> events{{from_us(1), 1, 1, Polarity::on},
                                    {from_us(900), 2, 1, Polarity::off}};
    fs::path path = fresh_folder("colour_bag") / "colour.bag";
    std::ofstream{path, std::ios::binary} << bag(chunk(
        "none", connection(3, "dvs_msgs/EventArray") + connection(5, "sensor_msgs/Image") +
                    message(3, event_array(6, 4, events)) + message(5, image(mosaic, encoding))));
    return path;
}

Array2<float> grey_of_first_image(const fs::path& path, std::optional<ColourFilter> bayer = {}) {
    return intensity_of(read_reference_sequence(path, {}, {}, {}, bayer).images.at(0));
}

TEST(ReferenceSequence, ImagesOfAColourCameraAreWhatItSawAndNoMosaic) {
    for (const Array2<float>& seen :
         {grey_of_first_image(colour_bag("bayer_grbg8")),
          grey_of_first_image(colour_bag("mono8"), ColourFilter::grbg),
          grey_of_first_image(colour_bag("bayer_bggr8"), ColourFilter::grbg)})
        for (const float v : seen.values())
            EXPECT_NEAR(v, (.299 * kRed + .701 * kOthers) / 65535, 1e-3);
}

TEST(ReferenceSequence, ImagesThatAreSaidToBeNoMosaicStayAsTheyAre) {
    const Array2<float> seen = grey_of_first_image(colour_bag("bayer_grbg8"), ColourFilter::none);
    EXPECT_NEAR(seen(0, 0), kOthers / 65535., 1e-5);
    EXPECT_NEAR(seen(0, 1), kRed / 65535., 1e-5);
}

/// Bytes of a recording from 0 on, an event each millisecond and an image each 100 ms.
std::string aedat3_bytes(const fs::path& path, int images) {
    StreamHeader header;
    header.width = header.height = 8;
    RecordingFile file{path.string(), true, open_writer("aedat3"), header};
    for (int i = 0; i < images; ++i) {
        Batch batch;
        for (int ms = 0; ms < 100; ++ms)
            batch.events.push_back(
                {from_us(1000 * (100 * i + ms)), std::uint16_t(ms % 8), 1, Polarity::on});
        ReferenceImage image;
        image.t = image.exposure_begin = image.exposure_end = batch.events.back().t;
        image.pixels = Array2<std::uint16_t>(8, 8);
        batch.add_image(image);
        file.write(batch);
    }
    file.finish();
    std::ifstream written{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{written}, {}};
}

TEST(ReferenceSequence, OfARecordingWhoseClockBeganAnewIsThePartWithMostImages) {
    const fs::path folder = fresh_folder("joined");
    const std::string longer = aedat3_bytes(folder / "longer.aedat", 5),
                      shorter = aedat3_bytes(folder / "shorter.aedat", 2);
    const ReferenceSequence alone = read_reference_sequence(folder / "longer.aedat");
    EXPECT_TRUE(alone.warnings.empty());
    for (const std::string& joined : {longer + shorter, shorter + longer, longer + longer}) {
        std::ofstream{folder / "joined.aedat", std::ios::binary} << joined;
        const ReferenceSequence part = read_reference_sequence(folder / "joined.aedat");
        EXPECT_EQ(part.events, alone.events);
        EXPECT_EQ(part.images, alone.images);
        EXPECT_EQ(part.first, alone.first);
        ASSERT_EQ(part.warnings.size(), 1U);
        EXPECT_THAT(part.warnings[0],
                    testing::HasSubstr("joined.aedat: its clock began anew 1 time"));
    }
}

TEST(ReferenceSequence, WhoseImagesHaveAnotherClockIsRefused) {
    const fs::path folder = write_recording(fresh_folder("clocks"), .5, .001, .1);
    std::ofstream events{folder / "events.txt"};
    for (int ms = 0; ms < 400; ++ms) events << 1'633'953'690'000 + ms << "e-3 1 2 1\n";
    events.close();
    try {
        read_reference_sequence(folder);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), testing::HasSubstr("one clock for images and events, found"));
    }
}

std::vector<std::int64_t> mended(const std::vector<std::int64_t>& times) {
    std::vector<ReferenceImage> images(times.size());
    for (std::size_t i = 0; i < times.size(); ++i) images[i].t = from_us(times[i]);
    mend_times(images);
    std::vector<std::int64_t> after;
    for (const ReferenceImage& image : images) after.push_back(to_us(image.t));
    return after;
}

TEST(ImageTimes, OneThatLiesAfterTheNextIsTheMiddleOfItsNeighbours) {
    using Times = std::vector<std::int64_t>;
    EXPECT_EQ(mended({0, 100, 50, 150}), (Times{0, 25, 50, 150}));
    EXPECT_EQ(mended({0, 10, 20, 30}), (Times{0, 10, 20, 30}));
    EXPECT_EQ(mended({0, 10, 10, 30}), (Times{0, 10, 10, 30}));
    // Of the first and the last there is no middle.
    EXPECT_EQ(mended({40, 10, 20}), (Times{10, 20, 40}));
    EXPECT_EQ(mended({7}), (Times{7}));
    EXPECT_EQ(mended({}), Times{});
}

TEST(ReferenceWindows, OfAnImageThatIsStoredTwiceAreOne) {
    ReferenceSequence sequence;
    for (const int t : {10, 10, 30}) sequence.images.emplace_back().t = from_us(t);
    std::vector<SensorTime> ends;
    for_each_reference_window(sequence,
                              [&](const EventWindow& cut) { ends.push_back(cut.window.end); });
    EXPECT_EQ(ends, (std::vector{from_us(10), from_us(30)}));
}

TEST(ReferenceWindows, EndAfterTheyBeginAlsoWhereTheTimesOfImagesDoNotAscend) {
    ReferenceSequence sequence;
    for (const int t : {10, 30, 20}) sequence.images.emplace_back().t = from_us(t);
    for (const int t : {15, 25}) sequence.events.push_back({from_us(t), 0, 0, Polarity::on});
    int windows = 0;
    for_each_reference_window(sequence, [&](const EventWindow& event_window) {
        ++windows;
        EXPECT_LE(event_window.events.size(), sequence.events.size());
    });
    EXPECT_EQ(windows, 2);
}

/// Events of one pixel each millisecond for 100 ms; images at 40, 75 and 130 ms.
ReferenceSequence short_sequence() {
    ReferenceSequence sequence{"short", 8, 8, {}, {}, {}, {}, {}};
    for (int ms = 0; ms < 100; ++ms)
        sequence.events.push_back({from_us(1000 * ms), 3, 3, Polarity::on});
    for (const int ms : {40, 75, 130}) sequence.images.emplace_back().t = from_us(1000 * ms);
    return sequence;
}

TEST(CutWindows, MayEndWhereTheImagesAre) {
    std::vector<SensorTime> ends;
    for_each_cut_window(short_sequence(), "aps", nullptr,
                        [&](const EventWindow& cut) { ends.push_back(cut.window.end); });
    EXPECT_EQ(ends, (std::vector{from_us(40'000), from_us(75'000), from_us(130'000)}));
}

TEST(CutWindows, HoldWhatAFilterHeldBackUntilTheEnd) {
    ReferenceSequence sequence{"lamp", 32, 24, {}, {}, {}, {}, {}};
    sequence.events = lamp_events({});
    const SensorTime end = sequence.events.back().t + SensorDuration{1000};
    // Each waits for the event of the other polarity that a lamp would make it fire.
    for (std::uint16_t x = 0; x < 20; ++x) sequence.events.push_back({end, x, 3, Polarity::on});
    sequence.images.emplace_back().t = end;
    const auto filter = event_filter(
        {.hot_pixels = "off", .noise_filter = "off", .lamp_flicker = "16ms"}, {}, 32, 24);
    std::size_t at_the_end = 0;
    for_each_cut_window(sequence, "10ms", filter.get(), [&](const EventWindow& cut) {
        at_the_end += std::size_t(std::ranges::count(cut.events, end, &Event::t));
    });
    EXPECT_EQ(at_the_end, 20U);
}

TEST(CutWindows, EndWhereTheyWouldWithoutTheNoiseFilter) {
    ReferenceSequence sequence{"noise", 64, 48, {}, {}, {}, {}, {}};
    const auto add = [&](std::int64_t t_us, int x, int y) {
        sequence.events.push_back(
            {from_us(t_us), std::uint16_t(x), std::uint16_t(y), Polarity::on});
    };
    const auto move_at = [&](std::int64_t t_us) {  // neighbours, which support each other
        for (int i = 0; i < 6; ++i) add(t_us + i, 10 + i % 3, 10 + i / 3);
    };
    move_at(0);
    for (int i = 1; i < 500; ++i) add(7000 * i, i * 29 % 64, i * 31 % 48);  // 3.5 s of noise
    move_at(3'500'000);
    sequence.images.emplace_back().t = from_us(3'500'006);
    const auto filter = event_filter({.hot_pixels = "off", .noise_filter = "1ms"}, {}, 64, 48);
    std::vector<Window> of_all, of_filtered;
    std::size_t events = 0;
    for_each_cut_window(sequence, "10ms", nullptr,
                        [&](const EventWindow& cut) { of_all.push_back(cut.window); });
    for_each_cut_window(sequence, "10ms", filter.get(), [&](const EventWindow& cut) {
        of_filtered.push_back(cut.window);
        events += cut.events.size();
    });
    EXPECT_LT(events, 20U);
    ASSERT_EQ(of_filtered.size(), of_all.size());
    for (std::size_t i = 0; i < of_all.size(); ++i) EXPECT_EQ(of_filtered[i].end, of_all[i].end);
}

}  // namespace
}  // namespace eventide::test
