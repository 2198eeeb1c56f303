// ROS 1 bags as recordings: events, packets and images of the usual messages.
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "tests/io/bag_writer.h"
#include "tests/replay/recording_files.h"

#include <gmock/gmock.h>

namespace eventide {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::uint32_t kEvents = 3, kImages = 5, kOther = 6;

ReferenceImage some_image(SensorTime t, int width, int height) {
    ReferenceImage made;
    made.t = made.exposure_begin = made.exposure_end = t;
    made.pixels = Array2<std::uint16_t>(height, width);
    for (std::size_t i = 0; i < made.pixels.values().size(); ++i)
        made.pixels.values()[i] = std::uint16_t(i * 3 % 256 * 257);
    return made;
}

/// Messages of 100 events and an image before each thousand, in chunks of 1000 events.
std::string bag_of(const std::vector<Event>& events, const std::string& packing,
                   const std::string& type = "dvs_msgs/EventArray", int image_width = 128) {
    BagBytes content, part = connection(kOther, "sensor_msgs/Imu") + connection(kEvents, type) +
                             connection(kImages, "sensor_msgs/Image") + message(kOther, "imu");
    for (std::size_t i = 0; i < events.size(); i += 100) {
        if (i % 1000 == 0)
            part += message(kImages, image(some_image(events[i].t, image_width, 128)));
        part += message(kEvents, event_array(128, 128, std::span(events).subspan(i, 100)));
        if (i % 1000 == 900) content += chunk(packing, std::exchange(part, {}));
    }
    return bag(content + (part.empty() ? "" : chunk(packing, part)),
               connection(kEvents, type) + connection(kImages, "sensor_msgs/Image"));
}

class BagRecordings : public testing::TestWithParam<const char*> {
protected:
    const TestFolder folder_;
    const std::vector<Event> events_ = some_events(20'000, 1'500'000'000'000'000);
};

INSTANTIATE_TEST_SUITE_P(Packings, BagRecordings, testing::Values("none", "bz2", "lz4"),
                         [](const auto& each) { return std::string(each.param); });

TEST_P(BagRecordings, GiveTheEventsAndImagesThatWereWritten) {
    for (const char* type : {"dvs_msgs/EventArray", "prophesee_event_msgs/EventArray"}) {
        const auto recording =
            open_recording(folder_.write("a.bag", bag_of(events_, GetParam(), type)));
        EXPECT_EQ(recording->info().format, "rosbag");
        EXPECT_EQ(recording->info().width, 128);
        EXPECT_EQ(recording->info().height, 128);
        EXPECT_TRUE(recording->remarks().empty());
        const Batch batch = read_everything(*recording);
        EXPECT_TRUE(batch.events == events_);
        ASSERT_EQ(batch.images.size(), 20U);
        EXPECT_TRUE(batch.images[7] == some_image(events_[7'000].t, 128, 128));
    }
}

TEST_P(BagRecordings, SeekThenReadIsReadThenSkip) {
    const auto recording = open_recording(folder_.write("a.bag", bag_of(events_, GetParam())));
    for (const std::size_t i : {std::size_t{15'500}, std::size_t{0}, std::size_t{8'001}}) {
        recording->seek(events_[i].t);
        if (i > 10'000) {
            EXPECT_GT(recording->position_bytes(), recording->size_bytes() / 2);
        }
        Batch batch = read_everything(*recording);
        const auto early = [&](const auto& item) { return item.t < events_[i].t; };
        std::erase_if(batch.events, early);
        std::erase_if(batch.images, early);
        std::vector<Event> expected = events_;
        std::erase_if(expected, early);
        EXPECT_TRUE(batch.events == expected) << i;
        EXPECT_EQ(batch.images.size(), 20 - (i + 999) / 1'000);
    }
}

TEST_P(BagRecordings, CutShortGiveWhatIsThere) {
    const std::string whole = bag_of(events_, GetParam());
    const Summary sum =
        summarize(*open_recording(folder_.write("a.bag", whole.substr(0, whole.size() / 2))));
    EXPECT_EQ(sum.damaged[DamageReason::truncated], 1U);
    EXPECT_GT(sum.events, events_.size() / 3);
    EXPECT_LT(sum.events, events_.size() * 2 / 3);
}

TEST(BagRecording, AChunkThatIsCutShortGivesItsWholeMessages) {
    const TestFolder folder;
    const auto events = some_events(1'000);
    BagBytes messages = connection(kEvents, "dvs_msgs/EventArray");
    for (std::size_t i = 0; i < events.size(); i += 100)
        messages += message(kEvents, event_array(128, 128, std::span(events).subspan(i, 100)));
    BagBytes bytes = bag(chunk("none", messages));
    bytes.resize(bytes.find(messages) + messages.size() - 50);
    const Summary sum = summarize(*open_recording(folder.write("a.bag", bytes)));
    EXPECT_EQ(sum.events, 900U);
    EXPECT_EQ(sum.damaged[DamageReason::truncated], 1U);
    EXPECT_EQ(sum.damaged.total(), 1U);
}

TEST(BagRecording, ADamagedChunkCostsOnlyItself) {
    const TestFolder folder;
    const auto events = some_events(20'000);
    std::string bytes = bag_of(events, "bz2");
    bytes[bytes.size() / 2] ^= char(0x5A);
    const Summary sum = summarize(*open_recording(folder.write("a.bag", bytes)));
    EXPECT_EQ(sum.damaged[DamageReason::bad_compression], 1U);
    EXPECT_EQ(sum.damaged.total(), 1U);
    EXPECT_EQ(sum.events, events.size() - 1'000);
}

TEST(BagRecording, ImagesOfAnotherCameraAreLeftOutAndNamed) {
    const TestFolder folder;
    const auto events = some_events(5'000);
    const auto recording =
        open_recording(folder.write("a.bag", bag_of(events, "none", "dvs_msgs/EventArray", 200)));
    ASSERT_EQ(recording->remarks().size(), 1U);
    EXPECT_THAT(recording->remarks()[0], AllOf(HasSubstr("200x128"), HasSubstr("left out")));
    const Batch batch = read_everything(*recording);
    EXPECT_TRUE(batch.events == events);
    EXPECT_TRUE(batch.images.empty());
}

TEST(BagRecording, AMosaicSaysItsColourFilter) {
    const TestFolder folder;
    const auto events = some_events(100);
    const auto recording = open_recording(folder.write(
        "a.bag", bag(chunk("none", connection(kEvents, "dvs_msgs/EventArray") +
                                       connection(kImages, "sensor_msgs/Image") +
                                       message(kEvents, event_array(128, 128, events)) +
                                       message(kImages, image(some_image(events.back().t, 128, 128),
                                                              "bayer_grbg8"))))));
    const Batch batch = read_everything(*recording);
    ASSERT_EQ(batch.images.size(), 1U);
    ReferenceImage expected = some_image(events.back().t, 128, 128);
    expected.filter = ColourFilter::grbg;
    EXPECT_TRUE(batch.images[0] == expected);
}

TEST(BagRecording, OfSeveralTopicsWithImagesTheFirstOfTheEventsSizeIsReadAndTheOthersNamed) {
    const TestFolder folder;
    const auto events = some_events(100);
    const auto at = [&](std::uint32_t number, int width) {
        return message(number, image(some_image(events[50].t, width, 128)));
    };
    const std::string type = "sensor_msgs/Image";
    const auto recording = open_recording(folder.write(
        "a.bag",
        bag(chunk("none", connection(kEvents, "dvs_msgs/EventArray", "/events") +
                              connection(10, type, "/wide") + connection(11, type, "/same") +
                              connection(12, type, "/also") + at(10, 200) + at(11, 128) +
                              at(12, 128) + message(kEvents, event_array(128, 128, events))))));
    EXPECT_EQ(read_everything(*recording).images.size(), 1U);
    EXPECT_THAT(recording->remarks(),
                testing::ElementsAre(AllOf(HasSubstr("/wide"), HasSubstr("200x128")),
                                     AllOf(HasSubstr("/also"), HasSubstr("those of /same"))));
}

TEST(BagRecording, ATopicThatASeekPassesOverIsKnownFromTheIndex) {
    const TestFolder folder;
    const auto events = some_events(100'000);
    const BagBytes known = connection(kEvents, "dvs_msgs/EventArray"),
                   late = connection(kImages, "sensor_msgs/Image");
    BagBytes content;
    for (std::size_t i = 0; i < events.size(); i += 500) {
        BagBytes part = i == 0 ? known : i == 45'000 ? late : "";
        part += message(kEvents, event_array(128, 128, std::span(events).subspan(i, 500)));
        if (i >= 45'000) part += message(kImages, image(some_image(events[i].t, 128, 128)));
        content += chunk("none", part);
    }
    for (const BagBytes& index : {known + late, BagBytes()}) {
        const auto recording = open_recording(folder.write("a.bag", bag(content, index)));
        recording->seek(events[80'000].t);
        const auto images = read_everything(*recording).images;
        EXPECT_GE(images.size(), 40U) << (index.empty() ? "no index" : "");
        recording->seek(events[10'000].t);
        EXPECT_EQ(read_everything(*recording).images.size(), 110U);
    }
}

/// A recorder may name a camera from which nothing came, or whose messages make no sense.
TEST(BagRecording, OfSeveralTopicsWithEventsTheFirstThatHasSomeIsRead) {
    const TestFolder folder;
    const auto events = some_events(100);
    const std::string type = "dvs_msgs/EventArray";
    const BagBytes other = message(10, event_array(0, 0, {}));
    for (const BagBytes& left : {BagBytes(), other}) {
        const auto recording = open_recording(folder.write(
            "a.bag", bag(chunk("none", connection(10, type, "/left") + left +
                                           connection(11, type, "/right") +
                                           message(11, event_array(128, 128, events))))));
        EXPECT_TRUE(read_everything(*recording).events == events);
        EXPECT_THAT(recording->remarks(),
                    testing::ElementsAre(AllOf(HasSubstr("/left has no events"),
                                               HasSubstr("those of /right are read"))));
    }
}

/// Of a stereo pair, with the images of both.
TEST(BagRecording, OfAPairTheEventsOfTheTopicThatIsWantedAreReadAndTheImagesBesideThem) {
    const TestFolder folder;
    const auto left = some_events(100), right = some_events(100, 5'000);
    const std::string events = "dvs_msgs/EventArray", images = "sensor_msgs/Image";
    const auto image_at = [&](std::uint32_t number, SensorTime t) {
        return message(number, image(some_image(t, 128, 128)));
    };
    const std::string path = folder.write(
        "a.bag", bag(chunk("none", connection(12, images, "/stereo/left/image_raw") +
                                       connection(13, images, "/stereo/right/image_raw") +
                                       connection(10, events, "/stereo/left/events") +
                                       connection(11, events, "/stereo/right/events") +
                                       message(10, event_array(128, 128, left)) +
                                       message(11, event_array(128, 128, right)) +
                                       image_at(12, left[5].t) + image_at(13, right[5].t))));
    const auto read = [&](const std::string& stream) {
        OpenOptions options;
        options.stream = stream;
        const auto recording = open_recording(path, options);
        return std::pair{read_everything(*recording), recording->remarks()};
    };
    for (const char* first : {"", "/stereo/left/events"}) {
        const auto [batch, remarks] = read(first);
        EXPECT_TRUE(batch.events == left);
        ASSERT_EQ(batch.images.size(), 1U);
        EXPECT_EQ(batch.images[0].t, left[5].t);
        EXPECT_THAT(remarks,
                    testing::UnorderedElementsAre(
                        "the images of /stereo/right/image_raw are left out, those of "
                        "/stereo/left/image_raw are read",
                        "the events of /stereo/right/events are left out, those of "
                        "/stereo/left/events are read; --input-stream /stereo/right/events (the "
                        "option stream of the library) reads those"));
    }
    const auto [batch, remarks] = read("/stereo/right/events");
    EXPECT_TRUE(batch.events == right);
    ASSERT_EQ(batch.images.size(), 1U);
    EXPECT_EQ(batch.images[0].t, right[5].t);
    for (const char* none : {"/stereo/left/image_raw", "/stereo/right", "events"}) {
        try {
            read(none);
            FAIL() << none;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_THAT(error.what(),
                        HasSubstr("expected events of the topic '" + std::string(none) +
                                  "' that can be read, found events of /stereo/left/events, "
                                  "/stereo/right/events"));
        }
    }
}

TEST(BagRecording, ImagesOfTheOtherCameraOfAPairAreNotTakenForTheFirstOnes) {
    const TestFolder folder;
    const auto events = some_events(100);
    const std::string type = "dvs_msgs/EventArray";
    const auto recording = open_recording(folder.write(
        "a.bag", bag(chunk("none", connection(10, type, "/left/events") +
                                       connection(11, type, "/right/events") +
                                       connection(12, "sensor_msgs/Image", "/right/image_raw") +
                                       message(10, event_array(128, 128, events)) +
                                       message(11, event_array(128, 128, events)) +
                                       message(12, image(some_image(events[0].t, 128, 128)))))));
    EXPECT_TRUE(read_everything(*recording).images.empty());
    EXPECT_THAT(recording->remarks(),
                testing::Contains(
                    "the images of /right/image_raw are left out: they are of another camera"));
}

TEST(BagRecording, WithoutEventsIsRefusedWithWhatItHas) {
    const TestFolder folder;
    const std::string path = folder.write(
        "a.bag", bag(chunk("none", connection(kOther, "sensor_msgs/Imu") + message(kOther, "x"))));
    try {
        open_recording(path);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), AllOf(HasSubstr("a.bag"), HasSubstr("found sensor_msgs/Imu")));
    }
}

/// Null where it is not at hand or cannot be read by this build, and `why_not` tells.
std::unique_ptr<Recording> open_known(const char* name, std::string& why_not) {
    const auto path = std::filesystem::path(EVENTIDE_SOURCE_DIR) / "../shared/data/formats" / name;
    if (!std::filesystem::exists(path)) {
        why_not = "no " + std::string{name} + " at hand";
        return nullptr;
    }
    try {
        return open_recording(path.string());
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::failed) throw;
        why_not = error.what();  // built without SQLite
        return nullptr;
    }
}

struct Known {
    const char* name;
    const char* format;
    std::uint64_t off, on;
};

class RealBags : public testing::TestWithParam<Known> {};

TEST_P(RealBags, GiveTheKnownNumbers) {
    const Known& known = GetParam();
    std::string why_not;
    const auto recording = open_known(known.name, why_not);
    if (!recording) GTEST_SKIP() << why_not;
    const Summary sum = summarize(*recording);
    EXPECT_EQ(sum.format, known.format);
    EXPECT_EQ(sum.events - sum.on, known.off);
    EXPECT_EQ(sum.on, known.on);
    EXPECT_EQ(sum.damaged.total(), 0U);
    recording->seek(*sum.first);
    EXPECT_EQ(read_everything(*recording).events.size(), sum.events);
}

INSTANTIATE_TEST_SUITE_P(All, RealBags,
                         testing::Values(Known{"ros1_events.bag", "rosbag", 218291, 125183},
                                         Known{"ros2_events.mcap", "mcap", 360223, 211043}),
                         [](const auto& each) { return std::string(each.param.format); });

/// Of these the sums of their events are known.
struct KnownSums {
    const char* name;
    std::uint64_t x, y, on;
};

class RealDb3 : public testing::TestWithParam<KnownSums> {};

TEST_P(RealDb3, GivesTheKnownSums) {
    const KnownSums& known = GetParam();
    std::string why_not;
    const auto recording = open_known(known.name, why_not);
    if (!recording) GTEST_SKIP() << why_not;
    EXPECT_EQ(recording->info().format, "db3");
    std::uint64_t x = 0, y = 0, on = 0;
    for (const Event& event : read_everything(*recording).events) {
        x += event.x;
        y += event.y;
        on += event.polarity == Polarity::on;
    }
    EXPECT_EQ(x, known.x);
    EXPECT_EQ(y, known.y);
    EXPECT_EQ(on, known.on);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealDb3,
    testing::Values(KnownSums{"ros2_evt3_trigger.db3", 42078718, 31656267, 41439},
                    KnownSums{"ros2_libcaer_rollover.db3", 111651612, 82801007, 181908}),
    [](const auto& each) { return std::to_string(each.index); });

}  // namespace
}  // namespace eventide
