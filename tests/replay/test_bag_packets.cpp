// Event packets in ROS 1 bags: their times, and messages that the recorder lost.
#include "replay/formats.h"
#include "replay/summary.h"
#include "tests/codec/evt3_words.h"
#include "tests/io/bag_writer.h"
#include "tests/replay/recording_files.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

using namespace test;

constexpr std::uint32_t kEvents = 3;

BagBytes packet_message(const std::string& encoding, std::uint64_t sequence, SensorTime stamp,
                        const BagBytes& payload) {
    return message(kEvents, message_header(stamp) + little(std::uint32_t{128}) +
                                little(std::uint32_t{128}) + little(sequence) +
                                little(std::uint64_t(to_us(stamp)) * 1'000) + block(encoding) +
                                BagBytes(1, '\0') + block(payload));
}

BagBytes mono(SensorTime stamp, std::span<const Event> events) {
    BagBytes payload;
    for (const Event& event : events)
        payload += little(std::uint64_t(to_us(event.t) - to_us(stamp)) * 1'000 |
                          std::uint64_t(event.x) << 32 | std::uint64_t(event.y) << 48 |
                          std::uint64_t(event.polarity) << 63);
    return payload;
}

BagBytes bag_of(const BagBytes& messages) {
    return bag(chunk("lz4", connection(kEvents, "event_camera_msgs/EventPacket") + messages));
}

TEST(BagPackets, HaveTheTimesOfRos) {
    const TestFolder folder;
    const auto events = some_events(5'000, 1'500'000'000);
    BagBytes messages;
    for (std::size_t i = 0; i < events.size(); i += 100)
        messages += packet_message("mono", i / 100, events[i].t,
                                   mono(events[i].t, std::span(events).subspan(i, 100)));
    const auto recording = open_recording(folder.write("a.bag", bag_of(messages)));
    EXPECT_TRUE(read_everything(*recording).events == events);
    recording->seek(events[3'000].t);
    std::vector<Event> late = read_everything(*recording).events, expected = events;
    const auto early = [&](const Event& event) { return event.t < events[3'000].t; };
    std::erase_if(late, early);
    std::erase_if(expected, early);
    EXPECT_TRUE(late == expected);
}

BagBytes payload_of(const evt3::Words& words) {
    BagBytes payload;
    for (const std::uint16_t word : words) payload += little(word);
    return payload;
}

/// The row and the time of what follows a lost message may have stood in it.
TEST(BagPackets, BehindALostMessageEvt3WaitsForItsNextTimeAndRow) {
    using namespace evt3;
    constexpr std::int64_t kStart = 1'500'000'000;  // us
    const TestFolder folder;
    const auto at = [](std::uint64_t sequence, const Words& words) {
        const SensorTime stamp = from_us(kStart + std::int64_t(sequence) * kHigh);
        return packet_message("evt3", sequence, stamp, payload_of(words));
    };
    const BagBytes messages = at(0, {time_high(0), addr_y(7), addr_x(1)}) +
                              at(1, {time_high(1), addr_x(2)}) +
                              // 2, which went on to another row, is missing
                              at(3, {addr_x(3), time_high(3), addr_x(4), addr_y(9), addr_x(5)}) +
                              at(4, {time_high(4), addr_x(6)});
    const auto recording = open_recording(folder.write("a.bag", bag_of(messages)));
    const std::vector<Event> expected{event(kStart, 1, 7), event(kStart + kHigh, 2, 7),
                                      event(kStart + 3 * kHigh, 5, 9),
                                      event(kStart + 4 * kHigh, 6, 9)};
    for (int reading = 0; reading < 2; ++reading) {
        EXPECT_EQ(read_everything(*recording).events, expected);
        recording->seek(SensorTime::min());
        const Summary sum = summarize(*recording);
        EXPECT_EQ(sum.damaged[DamageReason::bad_record], 1U) << "the gap";
        EXPECT_EQ(sum.damaged.total(), 1U);
        recording->seek(SensorTime::min());
    }
}

/// Nothing contradicts their time any more.
TEST(BagPackets, EventsBehindASilenceThatAreTheLastOnesAreThere) {
    const TestFolder folder;
    auto events = some_events(200, 1'500'000'000);
    for (std::size_t i = 100; i < events.size(); ++i) events[i].t += SensorDuration{10'000'000};
    BagBytes messages;
    for (std::size_t i = 0; i < events.size(); i += 100)
        messages += packet_message("mono", i / 100, events[i].t,
                                   mono(events[i].t, std::span(events).subspan(i, 100)));
    const auto recording = open_recording(folder.write("a.bag", bag_of(messages)));
    for (int reading = 0; reading < 2; ++reading) {
        EXPECT_TRUE(read_everything(*recording).events == events);
        recording->seek(SensorTime::min());
    }
}

TEST(BagPackets, ADriverThatDoesNotCountHasNoGaps) {
    const TestFolder folder;
    const auto events = some_events(300, 1'500'000'000);
    BagBytes messages;
    for (std::size_t i = 0; i < events.size(); i += 100)
        messages += packet_message("mono", 0, events[i].t,
                                   mono(events[i].t, std::span(events).subspan(i, 100)));
    const Summary sum = summarize(*open_recording(folder.write("a.bag", bag_of(messages))));
    EXPECT_EQ(sum.events, events.size());
    EXPECT_EQ(sum.damaged.total(), 0U);
}

}  // namespace
}  // namespace eventide
