// Seek then read = read then skip: for every format, real and made, whole and damaged.
#include "replay/formats.h"
#include "src/codec/aedat/aedat3.h"
#include "src/codec/aedat4/aedat4_writer.h"
#include "src/core/error.h"
#include "tests/replay/made_formats.h"

#include <algorithm>

namespace eventide {
namespace {

constexpr std::size_t kEvents = 150'000;

/// What a reader gets who seeks first; with `position`, how far into the file it begins.
std::vector<Event> events_from(const std::string& path, SensorTime t, double* position = nullptr) {
    const auto recording = open_recording(path);
    recording->seek(t);
    if (position) *position = double(recording->position_bytes()) / double(recording->size_bytes());
    return read_everything(*recording).events;
}

std::vector<Event> at_or_after(const std::vector<Event>& events, SensorTime t) {
    std::vector<Event> left;
    std::copy_if(events.begin(), events.end(), std::back_inserter(left),
                 [&](const Event& e) { return e.t >= t; });
    return left;
}

/// Both in order of time.
std::vector<Event> common(const std::vector<Event>& some, const std::vector<Event>& others) {
    std::vector<Event> both;
    for (const Event& event : some) {
        const auto [begin, end] =
            std::equal_range(others.begin(), others.end(), event,
                             [](const Event& a, const Event& b) { return a.t < b.t; });
        if (std::find(begin, end, event) != end) both.push_back(event);
    }
    return both;
}

class Seek : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Formats, Seek,
                         testing::Values("text", "aedat1", "aedat2", "aedat3", "aedat4", "evt2",
                                         "evt21", "evt3", "dat", "es"),
                         [](const auto& each) { return std::string(each.param); });

TEST_P(Seek, ThenReadIsReadThenSkip) {
    const TestFolder folder;
    const auto events = some_events(kEvents, 3'000'000);
    const std::string path = write_as(folder, GetParam(), events);
    for (const std::size_t i : {kEvents / 2, kEvents - 10, std::size_t(0), kEvents / 7}) {
        double position = 0;
        const SensorTime t = events[i].t;
        EXPECT_TRUE(at_or_after(events_from(path, t, &position), t) == at_or_after(events, t));
        if (i > kEvents / 4) {
            EXPECT_GT(position, 0.1) << "reads from the beginning";
        }
    }
}

TEST_P(Seek, GoesForthAndBack) {
    const TestFolder folder;
    const auto events = some_events(20'000);
    const auto recording = open_recording(write_as(folder, GetParam(), events));
    for (const std::size_t i : {std::size_t(19'000), std::size_t(100), std::size_t(10'000)}) {
        recording->seek(events[i].t);
        const Batch batch = read_everything(*recording);
        EXPECT_TRUE(at_or_after(batch.events, events[i].t) == at_or_after(events, events[i].t));
    }
    recording->seek(from_us(0));
    EXPECT_TRUE(read_everything(*recording).events == events);
}

TEST_P(Seek, FindsTimesBehindWraps) {
    // EVT3's 24 bits wrap five times, the 31 of AEDAT 1 and 2 once, the others not at all.
    const TestFolder folder;
    const auto events = some_events(40'000, (std::int64_t(1) << 31) - 40'000'000, 4'000);
    const std::string path = write_as(folder, GetParam(), events);
    const auto all = read_everything(*open_recording(path)).events;
    ASSERT_EQ(all.size(), events.size());
    for (const std::size_t i : {std::size_t(15'000), std::size_t(25'000), std::size_t(39'000)})
        EXPECT_TRUE(at_or_after(events_from(path, all[i].t), all[i].t) ==
                    at_or_after(all, all[i].t));
}

TEST_P(Seek, LosesNothingInDamagedFiles) {
    const TestFolder folder;
    const auto events = some_events(60'000, 3'000'000);
    const std::string whole = read_text(write_as(folder, GetParam(), events));
    for (unsigned seed = 0; seed < 5; ++seed) {
        std::mt19937 random(seed);
        std::string damaged = whole;
        for (int flips = 0; flips < 20; ++flips)
            damaged[5'000 + random() % (damaged.size() - 5'000)] ^= char(1 << random() % 8);
        const std::string path = folder.write("damaged", damaged);
        const auto all = read_everything(*open_recording(path)).events;
        for (const double share : {0.3, 0.6, 0.9}) {
            const SensorTime t = events[std::size_t(share * double(events.size()))].t;
            // Of what reading from the beginning finds, what is no damage itself.
            const auto found = at_or_after(events_from(path, t), t);
            const auto expected = common(at_or_after(all, t), events);
            EXPECT_EQ(common(found, expected).size(), expected.size())
                << "seed " << seed << ", from " << share;
        }
    }
}

TEST_P(Seek, BeyondTheEndsIsSafe) {
    const TestFolder folder;
    const auto events = some_events(20'000, 3'000'000);
    const std::string path = write_as(folder, GetParam(), events);
    EXPECT_TRUE(at_or_after(events_from(path, from_us(900'000'000)), from_us(900'000'000)).empty());
    EXPECT_TRUE(events_from(path, from_us(-5)) == events);
}

TEST(SeekInAedat4, BisectsWhereTheTableIsMissingOrDamaged) {
    const TestFolder folder;
    const auto events = some_events(kEvents, 3'000'000, 60);
    const std::string whole = read_text(write_as(folder, "aedat4", events));
    std::string flipped = whole;
    flipped[flipped.size() - 200] ^= 0x10;
    const SensorTime t = events[kEvents / 2].t;
    for (const std::string& content : {whole, flipped, whole.substr(0, whole.size() - 300)}) {
        const std::string path = folder.write("b.aedat4", content);
        double position = 0;
        EXPECT_TRUE(at_or_after(events_from(path, t, &position), t) == at_or_after(events, t));
        EXPECT_GT(position, 0.25);
    }
}

void no_event_is_passed_before_a_trigger(StreamWriter& writer) {
    const TestFolder folder;
    const auto events = some_events(kEvents, 3'000'000, 60);
    StreamHeader header;
    header.width = header.height = 128;
    std::vector<std::byte> bytes;
    writer.begin(header, bytes);
    for (std::size_t i = 0; i < events.size(); i += 5000) {
        Batch batch, trigger, image;
        batch.events.assign(events.begin() + std::ptrdiff_t(i),
                            events.begin() + std::ptrdiff_t(i + 5000));
        writer.write(batch, bytes);
        trigger.triggers = {{events[i].t, Trigger::Kind::rising, 0}};
        writer.write(trigger, bytes);
        image.images.resize(1);  // large: nothing near the trigger tells another time
        image.images[0].t = image.images[0].exposure_begin = image.images[0].exposure_end =
            batch.events.back().t;
        image.images[0].pixels = Array2<std::uint16_t>(128, 128);
        writer.write(image, bytes);
    }
    const std::string path =  // without a table
        folder.write("a", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    for (std::size_t i = 4'000; i < events.size(); i += 3'001)
        EXPECT_TRUE(at_or_after(events_from(path, events[i].t), events[i].t) ==
                    at_or_after(events, events[i].t))
            << i;
}

TEST(SeekInAedat4, BisectionPassesNoEventsBeforeATriggerOfTheirTime) {
    Aedat4Writer writer(Aedat4Compression::none);
    no_event_is_passed_before_a_trigger(writer);
}

TEST(SeekInAedat3, BisectionPassesNoEventsBeforeATriggerOfTheirTime) {
    Aedat3Writer writer;
    no_event_is_passed_before_a_trigger(writer);
}

TEST(SeekInText, RowsOutOfOrderAreFound) {
    const TestFolder folder;
    auto events = some_events(60'000, 3'000'000);
    std::mt19937 random(1);
    std::vector<std::pair<SensorTime, Event>> rows;
    for (const Event& event : events)
        rows.emplace_back(event.t + SensorDuration(random() % 400 == 0 ? 0 : 9'000), event);
    std::ranges::stable_sort(rows, {}, [](const auto& row) { return row.first; });
    std::string text = "128 128\n";
    for (const auto& [due, e] : rows)
        text += "3." + std::to_string(to_us(e.t)).substr(1) + " " + std::to_string(e.x) + " " +
                std::to_string(e.y) + " " + std::to_string(int(e.polarity)) + "\n";
    const std::string path = folder.write("a.txt", text);
    const auto all = read_everything(*open_recording(path)).events;
    ASSERT_EQ(all.size(), events.size());
    for (std::size_t i = 1'000; i < all.size(); i += 1'003)
        EXPECT_EQ(at_or_after(events_from(path, all[i].t), all[i].t).size(),
                  at_or_after(all, all[i].t).size())
            << i;
}

TEST(SeekInText, OfTooFewOrNoLinesIsSafe) {
    const TestFolder folder;
    const std::string few = folder.write("a.txt", "9 9\n0.1 1 2 1\n0.2 1 2 1\n");
    EXPECT_EQ(events_from(few, from_us(200'000)).size(), 2U);
    const std::string junk =
        folder.write("b.txt", "9 9\n0.1 1 2 1\n" + std::string(std::size_t(1) << 20, 'x'));
    EXPECT_EQ(events_from(junk, from_us(200'000)).size(), 1U);
}

class SeekInRealRecordings : public testing::TestWithParam<const char*> {};

TEST_P(SeekInRealRecordings, ThenReadIsReadThenSkip) {
    const auto path =
        std::filesystem::path(EVENTIDE_SOURCE_DIR) / ".." / "shared" / "data" / GetParam();
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << GetParam() << " at hand";
    const Batch all = read_everything(*open_recording(path.string()));
    for (const double share : {0.02, 0.5, 0.97}) {
        const SensorTime t = all.events[std::size_t(share * double(all.events.size()))].t;
        const auto recording = open_recording(path.string());
        recording->seek(t);
        const Batch found = read_everything(*recording);
        EXPECT_TRUE(at_or_after(found.events, t) == at_or_after(all.events, t)) << share;
        const auto later = [&](const auto& item) { return item.t >= t; };
        EXPECT_EQ(std::ranges::count_if(found.imu, later), std::ranges::count_if(all.imu, later));
        EXPECT_EQ(std::ranges::count_if(found.images, later),
                  std::ranges::count_if(all.images, later));
    }
}

INSTANTIATE_TEST_SUITE_P(All, SeekInRealRecordings,
                         testing::Values("recordings/camerashake_b", "recordings/slider_depth_head",
                                         "formats/davis240_imu_rotdisk.aedat2",
                                         "formats/dvs128_short.aedat2",
                                         "formats/davis346_robotarm.aedat4",
                                         "formats/davis346_desk.aedat4", "formats/evt2_640x480.raw",
                                         "formats/evt3_1280x720_5000.raw",
                                         "formats/ncars_4407_td.dat"));

}  // namespace
}  // namespace eventide
