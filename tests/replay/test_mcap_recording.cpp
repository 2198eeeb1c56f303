// MCAP recordings: chunks, channels, and files that are cut short.
#include "replay/formats.h"
#include "replay/summary.h"
#include "tests/io/bag_writer.h"
#include "tests/replay/recording_files.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

using namespace test;

BagBytes mcap_record(int kind, const BagBytes& content) {
    return BagBytes(1, char(kind)) + little(std::uint64_t(content.size())) + content;
}

/// CDR: as ROS 1, but for the four bytes in front, no number in the header, and padding.
BagBytes cdr_event_array(int width, int height, std::span<const Event> events) {
    BagBytes bytes = ros_time({}) + little(std::uint32_t{4}) + BagBytes("dvs\0", 4) +
                     little(std::uint32_t(height)) + little(std::uint32_t(width)) +
                     little(std::uint32_t(events.size()));
    for (const Event& event : events) {
        bytes.resize((bytes.size() + 1) / 2 * 2);
        bytes += little(event.x) + little(event.y);
        bytes.resize((bytes.size() + 3) / 4 * 4);
        bytes += ros_time(event.t) + BagBytes(1, char(event.polarity));
    }
    return BagBytes("\0\1\0\0", 4) + bytes;
}

const BagBytes kMcapBegin = BagBytes("\x89MCAP0\r\n", 8);

BagBytes mcap_channel(int number, const BagBytes& name, const BagBytes& type,
                      const BagBytes& wire = "cdr") {
    return mcap_record(3,
                       little(std::uint16_t(number)) + block(type) + block("ros2msg") + block("")) +
           mcap_record(4, little(std::uint16_t(number)) + little(std::uint16_t(number)) +
                              block(name) + block(wire) + block(""));
}

BagBytes mcap_events(int channel, std::span<const Event> events) {
    return mcap_record(
        5, little(std::uint16_t(channel)) + BagBytes(20, '\0') + cdr_event_array(128, 128, events));
}

TEST(McapRecording, AMessageBeforeItsChannelIsDamageAtEveryReading) {
    const TestFolder folder;
    const auto events = some_events(300, 1'500'000'000'000'000);
    const auto part = [&](std::size_t i) { return std::span(events).subspan(100 * i, 100); };
    const BagBytes bytes = kMcapBegin + mcap_channel(7, "/events", "dvs_msgs/msg/EventArray") +
                           mcap_events(8, part(0)) + mcap_events(7, part(1)) +
                           mcap_channel(8, "/events", "dvs_msgs/msg/EventArray") +
                           mcap_events(8, part(2));
    const auto recording = open_recording(folder.write("a.mcap", bytes));
    const std::vector<Event> expected(events.begin() + 100, events.end());
    EXPECT_TRUE(read_everything(*recording).events == expected);
    recording->seek(SensorTime::min());
    const Summary again = summarize(*recording);
    EXPECT_EQ(again.events, 200U);
    EXPECT_EQ(again.damaged[DamageReason::bad_record], 1U);
    EXPECT_EQ(again.damaged.total(), 1U);
}

TEST(McapRecording, AChannelThatIsToldAnewIsReadFromThereOnAtEveryReading) {
    const TestFolder folder;
    const auto events = some_events(300, 1'500'000'000'000'000);
    const auto part = [&](std::size_t i) { return std::span(events).subspan(100 * i, 100); };
    const char* type = "dvs_msgs/msg/EventArray";
    const BagBytes bytes = kMcapBegin + mcap_channel(8, "/events", type, "json") +
                           mcap_channel(7, "/events", type) + mcap_events(8, part(0)) +
                           mcap_events(7, part(1)) + mcap_channel(8, "/events", type) +
                           mcap_events(8, part(2));
    const auto recording = open_recording(folder.write("a.mcap", bytes));
    const std::vector<Event> expected(events.begin() + 100, events.end());
    EXPECT_TRUE(read_everything(*recording).events == expected);
    recording->seek(SensorTime::min());
    EXPECT_TRUE(read_everything(*recording).events == expected);
}

/// As a converter makes it of a ROS 1 bag.
TEST(McapRecording, MessagesOfRos1AreReadAsABagsAre) {
    const TestFolder folder;
    const auto events = some_events(300, 1'500'000'000'000'000);
    BagBytes bytes = kMcapBegin + mcap_channel(7, "/dvs/events", "dvs_msgs/EventArray", "ros1");
    for (std::size_t i = 0; i < events.size(); i += 100)
        bytes += mcap_record(5, little(std::uint16_t{7}) + BagBytes(20, '\0') +
                                    event_array(128, 128, std::span(events).subspan(i, 100)));
    const auto recording = open_recording(folder.write("a.mcap", bytes));
    EXPECT_EQ(recording->info().width, 128);
    EXPECT_TRUE(read_everything(*recording).events == events);
    recording->seek(SensorTime::min());
    EXPECT_TRUE(read_everything(*recording).events == events);
}

TEST(McapRecording, GivesTheEventsThatWereWritten) {
    const TestFolder folder;
    const auto events = some_events(5'000, 1'500'000'000'000'000);
    BagBytes records = mcap_channel(7, "/events", "dvs_msgs/msg/EventArray");
    for (std::size_t i = 0; i < events.size(); i += 100)
        records += mcap_events(7, std::span(events).subspan(i, 100));
    for (const char* packing : {"", "lz4"}) {
        const BagBytes packed_records = packed(packing, records);
        const BagBytes bytes =
            kMcapBegin + mcap_record(1, block("ros2") + block("test")) +
            mcap_record(6, BagBytes(16, '\0') + little(std::uint64_t(records.size())) +
                               BagBytes(4, '\0') + block(packing) +
                               little(std::uint64_t(packed_records.size())) + packed_records) +
            mcap_record(2, BagBytes(20, '\0')) + kMcapBegin;
        const auto recording = open_recording(folder.write("a.mcap", bytes));
        EXPECT_EQ(recording->info().width, 128);
        EXPECT_TRUE(read_everything(*recording).events == events) << packing;
        const Summary cut =
            summarize(*open_recording(folder.write("b.mcap", bytes + bytes.substr(8, 30))));
        EXPECT_EQ(cut.events, events.size());
    }
    const BagBytes bytes =
        kMcapBegin + mcap_record(6, BagBytes(16, '\0') + little(std::uint64_t(records.size())) +
                                        BagBytes(4, '\0') + block("") +
                                        little(std::uint64_t(records.size())) + records);
    const Summary part =
        summarize(*open_recording(folder.write("c.mcap", bytes.substr(0, bytes.size() - 50))));
    EXPECT_EQ(part.events, events.size() - 100) << "whole messages of a chunk that is cut short";
    EXPECT_EQ(part.damaged[DamageReason::truncated], 1U);
    EXPECT_EQ(part.damaged.total(), 1U);
}

}  // namespace
}  // namespace eventide
