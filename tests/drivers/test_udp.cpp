// UDP over this machine's loopback: what is sent is what is read.
#include "drivers/udp/udp_source.h"
#include "replay/udp_target.h"
#include "replay/written_data.h"
#include "src/core/error.h"
#include "tests/support/holdings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace eventide {
namespace {

using testing::HasSubstr;

std::vector<Event> random_events(unsigned seed, std::size_t n, std::int64_t first_us = 0) {
    std::mt19937 random(seed);
    std::vector<Event> events;
    for (std::int64_t t = first_us; events.size() < n; t += std::int64_t(random() % 100))
        events.push_back({from_us(t), std::uint16_t(random() % 640), std::uint16_t(random() % 480),
                          Polarity(random() % 2)});
    return events;
}

std::string name_of(const UdpSource& source, const std::string& format) {
    return "udp://127.0.0.1:" + std::to_string(source.port()) + "?format=" + format;
}

UdpSource source_of(const std::string& format) {
    return UdpSource(UdpName::parse("//127.0.0.1:0?size=640x480&format=" + format));
}

/// Reads until as many events came; a limit stands for a datagram that never does.
Batch receive(UdpSource& source, std::size_t events) {
    const auto parser = source.make_parser();
    Batch batch;
    RawPacket packet;
    for (int waits = 0; batch.events.size() < events && waits < 500;) {
        if (source.read(packet) == ReadStatus::timeout) {
            ++waits;
            continue;
        }
        parser->arrives(packet.arrived);
        parser->parse(packet.bytes, batch);
        if (batch.events.size() + 1 == events) parser->finish(batch);  // one waits for the next
    }
    return batch;
}

class Udp : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Formats, Udp,
                         testing::Values("t64", "t32", "spif", "t64_x16_y16_on8",
                                         "t32_x16_y15_on1"),
                         [](const auto& each) { return std::string(each.param); });

TEST_P(Udp, EventsAreReadAsTheyWereSent) {
    UdpSource source = source_of(GetParam());
    StreamHeader header;
    header.width = 640;
    header.height = 480;
    UdpTarget target(name_of(source, GetParam()), header);
    Batch sent;
    sent.events = random_events(3, 2'000, 5'000'000);
    target.write(sent);
    target.finish();
    EXPECT_TRUE(receive(source, sent.events.size()).events == sent.events);
    EXPECT_EQ(source.counters()[CameraCount::transfers], 20U);
    EXPECT_EQ(source.counters()[CameraCount::bytes], target.bytes_written());
    EXPECT_EQ(target.lost(), 0U);
}

/// A port of this machine at which nobody listens.
std::uint16_t free_port() {
    return UdpSocket::listening(UdpName::parse("//127.0.0.1:0")).port();
}

TEST(Udp, EveryDatagramThatNobodyReceivedIsCounted) {
    constexpr std::uint64_t kDatagrams = 20;
    UdpTarget target("udp://127.0.0.1:" + std::to_string(free_port()), {});
    Batch sent;
    sent.events = random_events(3, kDatagrams * UdpTarget::kEventsAtATime);
    target.write(sent);
    target.finish();
    EXPECT_EQ(target.lost(), kDatagrams);
}

TEST(Udp, WhoeverBeginsToListenMissesNothingFromThenOn) {
    const std::uint16_t port = free_port();
    UdpSocket socket = UdpSocket::sending(UdpName::parse("//127.0.0.1:" + std::to_string(port)));
    const std::array<std::byte, 3> first{}, second{std::byte{7}};
    EXPECT_TRUE(socket.send(first));
    UdpSocket listener =
        UdpSocket::listening(UdpName::parse("//127.0.0.1:" + std::to_string(port)));
    EXPECT_TRUE(socket.send(second)) << "the first was refused, not this one";
    std::array<std::byte, 8> got{};
    EXPECT_EQ(listener.receive(got, std::chrono::seconds{5}), second.size());
    EXPECT_EQ(got[0], second[0]);
    EXPECT_EQ(socket.take_refused(), 1U);
    EXPECT_EQ(socket.take_refused(), 0U);
}

TEST(Udp, AClockThatBeganAnewIsSentAsItIs) {
    UdpSource source = source_of("t64");
    UdpTarget target(name_of(source, "t64"), {});
    Batch sent;
    sent.events = random_events(1, 100, 9'000'000);
    for (const Event& event : random_events(2, 100)) sent.events.push_back(event);
    WrittenData data{target.holds()};
    data.fit(sent);
    EXPECT_EQ(data.restarts(), 0U);
    target.write(sent);
    const std::size_t taken_for_late = UdpRecordsParser::kEventsOfAnother - 1;
    const Batch heard = receive(source, sent.events.size() - taken_for_late);
    EXPECT_EQ(heard.events.back(), sent.events.back());
    ASSERT_EQ(heard.triggers.size(), 1U);
    EXPECT_EQ(heard.triggers[0].kind, Trigger::Kind::timestamp_reset);
}

TEST(Udp, ADatagramThatEndsWithinARecordIsCountedAndItsWholeOnesRead) {
    UdpSource source = source_of("t64");
    UdpSocket socket =
        UdpSocket::sending(UdpName::parse("//127.0.0.1:" + std::to_string(source.port())));
    const auto events = random_events(1, 3);
    std::vector<std::byte> bytes;
    append_udp_records(UdpRecords::t64, events, bytes);
    bytes.resize(bytes.size() - 5);
    ASSERT_TRUE(socket.send(std::span(bytes).first(5)));
    ASSERT_TRUE(socket.send(bytes));
    EXPECT_TRUE(receive(source, 2).events ==
                std::vector<Event>(events.begin(), events.begin() + 2));
    EXPECT_EQ(source.counters()[CameraCount::cut_transfers], 2U);
    EXPECT_EQ(source.counters()[CameraCount::transfers], 1U) << "the other one gave nothing";
}

TEST(Udp, AFloodOfPiecesOfRecordsDoesNotHoldUpARead) {
    UdpSource source = source_of("t64");
    UdpSocket socket =
        UdpSocket::sending(UdpName::parse("//127.0.0.1:" + std::to_string(source.port())));
    const std::vector<std::byte> piece(5);
    for (int i = 0; i < 2000; ++i) socket.send(piece);
    RawPacket packet;
    EXPECT_EQ(source.read(packet), ReadStatus::timeout);
    EXPECT_LE(source.counters()[CameraCount::cut_transfers], 1024U);
}

TEST(Udp, WhatComesTogetherIsOnePacket) {
    UdpSource source = source_of("t64");
    UdpTarget target(name_of(source, "t64"), {});
    Batch sent;
    sent.events = random_events(1, 1'000);
    target.write(sent);
    RawPacket packet;
    ASSERT_EQ(source.read(packet), ReadStatus::data);
    EXPECT_EQ(packet.bytes.size(), target.bytes_written());
    EXPECT_EQ(source.counters()[CameraCount::transfers], 10U);
}

TEST(Udp, DatagramsThatTheSystemHadNoRoomForAreAGap) {
    UdpSource source = source_of("t64");
    UdpSocket socket =
        UdpSocket::sending(UdpName::parse("//127.0.0.1:" + std::to_string(source.port())));
    const std::vector<std::byte> large(60'008, std::byte{1});  // whole records, damaged or not
    for (int i = 0; i < 400; ++i) socket.send(std::span(large).first(13 * 4'600));
    RawPacket packet;
    while (source.read(packet) == ReadStatus::data) EXPECT_LT(packet.bytes.size(), 400'000U);
    const std::uint64_t read = source.counters()[CameraCount::transfers];
    // What came before the loss was told without it; the next one tells.
    ASSERT_LT(read, 400U);
    socket.send(std::span(large).first(13));
    ASSERT_EQ(source.read(packet), ReadStatus::data);
    EXPECT_TRUE(packet.gap_before);
    EXPECT_EQ(source.counters()[CameraCount::lost_transfers], 400 - read);
    socket.send(std::span(large).first(13));
    ASSERT_EQ(source.read(packet), ReadStatus::data);
    EXPECT_FALSE(packet.gap_before) << "told once";
}

TEST(Udp, AddressesOfIPv6StandInBrackets) {
    const UdpName name = UdpName::parse("//[::1]:4000?size=4x4");
    EXPECT_EQ(name.host, "::1");
    EXPECT_EQ(name.text(), "udp://[::1]:4000");
    std::optional<UdpSource> source;
    try {
        source.emplace(UdpName::parse("//[::1]:0?size=640x480"));
    } catch (const Error& error) {
        GTEST_SKIP() << error.what();
    }
    UdpTarget target("udp://[::1]:" + std::to_string(source->port()), {});
    Batch sent;
    sent.events = random_events(1, 200);
    target.write(sent);
    EXPECT_TRUE(receive(*source, sent.events.size()).events == sent.events);
}

TEST(Udp, NamesThatMakeNoSenseAreRefused) {
    const auto refusal = [](const std::string& name, ErrorKind kind) -> std::string {
        try {
            UdpSource{UdpName::parse(name)};
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), kind) << error.what();
            return error.what();
        }
        return "nothing was refused";
    };
    for (const std::string name :
         {"127.0.0.1:0", "//127.0.0.1", "//:0", "//127.0.0.1:0?size", "//127.0.0.1:0?=4x4",
          "//[]:9999", "//[127.0.0.1]:9999", "//[[::1]]:9999", "//[::1:9999"})
        EXPECT_THAT(refusal(name, ErrorKind::usage), HasSubstr("udp://HOST:PORT"));
    EXPECT_THAT(refusal("//127.0.0.1:0", ErrorKind::usage), HasSubstr("?size=640x480"));
    for (const std::string size : {"4", "0x4", "4x0", "4097x4", "4x4097"})
        EXPECT_THAT(refusal("//127.0.0.1:0?size=" + size, ErrorKind::usage),
                    HasSubstr("found '" + size + "'"));
    EXPECT_THAT(refusal("//127.0.0.1:0?size=4x4&speed=2", ErrorKind::usage),
                HasSubstr("expected size=WxH and format=, found 'speed'"));
    for (const std::string port : {"65536", "99999", "-1", "5x", "dns", ""})
        EXPECT_THAT(refusal("//127.0.0.1:" + port + "?size=4x4", ErrorKind::usage),
                    HasSubstr("from 0 to 65535, found '" + port + "'"));
    EXPECT_THAT(refusal("//127.0.0.1:0?size=4x4&format=t16", ErrorKind::usage),
                HasSubstr("t64, t32 or spif"));
    UdpSource source = source_of("t64");
    EXPECT_THAT(
        refusal("//127.0.0.1:" + std::to_string(source.port()) + "?size=4x4", ErrorKind::device),
        HasSubstr("in use"));
    EXPECT_THROW(UdpTarget("udp://127.0.0.1:0", {}), Error) << "nobody listens at port 0";
}

TEST(Udp, WhatTheRecordsCannotHoldIsRefused) {
    const auto refusal = [](const std::string& query, const StreamHeader& header,
                            std::int64_t first_us) -> std::string {
        try {
            UdpTarget target("udp://127.0.0.1:9" + query, header);
            Batch batch;
            batch.events = random_events(1, 10, first_us);
            target.write(batch);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
            return error.what();
        }
        return "nothing was refused";
    };
    StreamHeader small, large;
    large.height = 32769;
    EXPECT_THAT(refusal("?format=t16", small, 0), HasSubstr("found 'format=t16'"));
    EXPECT_THAT(refusal("?size=4x4", small, 0), HasSubstr("found 'size=4x4'"));
    EXPECT_THAT(refusal("?format=t32", large, 0), HasSubstr("at most 32768 px"));
    EXPECT_THAT(refusal("?format=t64", large, 0), HasSubstr("nothing"));
    large.height = 32768;
    EXPECT_THAT(refusal("?format=spif", large, 0), HasSubstr("nothing"));
    EXPECT_THAT(refusal("", small, -7), HasSubstr("expected times from 0 us, found -7 us"));
    EXPECT_THAT(refusal("?format=t32", small, -7), HasSubstr("nothing"));
}

TEST(Udp, OpenedAndClosedLeavesNothingBehind) {
    StreamHeader header;
    header.width = 640;
    header.height = 480;
    Batch sent;
    sent.events = random_events(3, 200, 5'000'000);
    test::expect_nothing_left([&] {
        UdpSource source = source_of("t64");
        UdpTarget target(name_of(source, "t64"), header);
        target.write(sent);
        target.finish();
        EXPECT_EQ(receive(source, sent.events.size()).events.size(), sent.events.size());
    });
}

TEST(Udp, StopEndsAWaitingRead) {
    UdpSource source = source_of("t64");
    source.stop();
    RawPacket packet;
    EXPECT_EQ(source.read(packet), ReadStatus::end);
}

}  // namespace
}  // namespace eventide
