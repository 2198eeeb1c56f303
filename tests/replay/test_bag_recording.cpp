// ROS 1 bags as recordings: events and images of the usual messages.
#include "replay/formats.h"
#include "replay/summary.h"
#include "tests/replay/recording_files.h"
#include "tests/replay/some_bags.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

using namespace test;

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

TEST(BagRecording, AnImageWithATimeOfItsOwnIsNoSilence) {
    const TestFolder folder;
    const auto events = some_events(300, 1'000'000);
    const SensorTime end = events.back().t, far = end + std::chrono::hours(1);
    const SensorDuration frame = std::chrono::milliseconds(40);
    const auto clock_with = [&](std::initializer_list<SensorTime> images) {
        BagBytes content = connection(kEvents, "dvs_msgs/EventArray") +
                           connection(kImages, "sensor_msgs/Image") +
                           message(kEvents, event_array(128, 128, events));
        for (const SensorTime t : images)
            content += message(kImages, image(some_image(t, 128, 128)));
        return clock_at_end(*open_recording(folder.write("a.bag", bag(chunk("none", content)))));
    };
    EXPECT_EQ(clock_with({far, end + frame}), end + frame);
    EXPECT_EQ(clock_with({far, far + frame}), far + frame);
    EXPECT_EQ(clock_with({far}), far) << "nothing contradicts it";
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

}  // namespace
}  // namespace eventide
