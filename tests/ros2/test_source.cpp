// A ROS 2 driver as a source: what is published is what is parsed.
#include "drivers/ros2/ros2_source.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "tests/ros2/image_cdr.h"
#include "tests/ros2/topics.h"
#include "tests/support/holdings.h"
#include "tests/system/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// "mono": `ns` after the message's time base.
std::uint64_t mono(std::uint32_t ns, unsigned x, unsigned y, bool on) {
    return ns | std::uint64_t{x} << 32 | std::uint64_t{y} << 48 | std::uint64_t{on} << 63;
}

std::vector<std::byte> bytes_of(const std::vector<std::uint64_t>& words) {
    std::vector<std::byte> bytes;
    for (const std::uint64_t word : words) append_little(bytes, word);
    return bytes;
}

constexpr std::int64_t kStamp = 1'700'000'000'000'000'000;  // ns

class Ros2SourceTest : public testing::Test {
protected:
    /// Message k has one event, at 10 k us of the sensor, in column k % 64.
    static EventPublisher::Message message(std::uint64_t k) {
        EventPublisher::Message message;
        message.seq = k;
        message.time_base = 10'000 * k;
        message.stamp_ns = kStamp + 10'000 * std::int64_t(k);
        message.payload = bytes_of({mono(0, unsigned(k % 64), 7, true)});
        return message;
    }

    /// Opens the source while messages are published, which it waits for: number k is the first.
    std::unique_ptr<Camera> open(EventPublisher& publisher, const EventPublisher::Message& first,
                                 CameraOptions options = {}) {
        auto opened = std::async(std::launch::async,
                                 [&] { return open_ros2_source(name_ + "?wait=60s", options); });
        publisher.wait_for_readers(1);
        publisher.publish(first);
        return opened.get();
    }

    /// What it has to say goes to `warnings`.
    static CameraOptions reconnecting(std::vector<std::string>& warnings) {
        CameraOptions options;
        options.reconnect = true;
        options.warn = [&warnings](const std::string& text) { warnings.push_back(text); };
        return options;
    }
    struct Heard {
        std::vector<Event> events;
        int gaps = 0;
    };
    /// Reads until there are `n` events.
    static Heard read(Camera& source, Parser& parser, std::size_t n) {
        Heard heard;
        RawPacket packet;
        Batch batch;
        while (batch.events.size() < n) {
            const ReadStatus status = source.read(packet);
            if (status == ReadStatus::end) break;
            if (status == ReadStatus::timeout) continue;
            if (packet.gap_before) {
                ++heard.gaps;
                parser.resync();
            }
            parser.parse(packet.bytes, batch);
        }
        heard.events = batch.events;
        return heard;
    }
    static Event event(std::uint64_t k) {
        return {from_us(kStamp / 1000 + 10 * std::int64_t(k)), std::uint16_t(k % 64), 7,
                Polarity::on};
    }

    std::string error_of(const std::function<void()>& call, ErrorKind kind = ErrorKind::device) {
        try {
            call();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), kind);
            return error.what();
        }
        ADD_FAILURE() << "nothing was thrown";
        return {};
    }

    const std::string name_ =
        own_name("/" + std::string{testing::UnitTest::GetInstance()->current_test_info()->name()});
};

TEST_F(Ros2SourceTest, GivesWhatIsPublishedInRosTime) {
    for (const bool reliable : {true, false}) {
        EventPublisher publisher{name_, reliable};
        const auto source = open(publisher, message(0));
        EXPECT_EQ(source->info().width, 64);
        EXPECT_EQ(source->info().height, 48);
        EXPECT_EQ(source->info().format, "mono");
        EXPECT_TRUE(source->is_live());
        const auto parser = source->make_parser();
        constexpr std::size_t kMessages = 200;
        for (std::size_t k = 1; k < kMessages; ++k) publisher.publish(message(k));
        const Heard heard = read(*source, *parser, kMessages);
        EXPECT_EQ(heard.gaps, 0);
        ASSERT_EQ(heard.events.size(), kMessages);
        for (std::size_t k = 0; k < kMessages; ++k) EXPECT_EQ(heard.events[k], event(k)) << k;
        EXPECT_EQ(parser->damaged().total(), 0U);
    }
}

TEST_F(Ros2SourceTest, OpenedAndClosedLeavesNothingBehind) {
    expect_nothing_left([&] {
        EventPublisher publisher{name_};
        const auto source = open(publisher, message(0));
        const auto parser = source->make_parser();
        publisher.publish(message(1));
        EXPECT_EQ(read(*source, *parser, 2).events.size(), 2U);
    });
}

TEST_F(Ros2SourceTest, AJumpOfTheNumbersIsAGap) {
    EventPublisher publisher{name_};
    const auto source = open(publisher, message(0));
    const auto parser = source->make_parser();
    for (const std::uint64_t k : {1, 2, 5, 6, 9}) publisher.publish(message(k));
    const Heard heard = read(*source, *parser, 6);
    EXPECT_EQ(heard.gaps, 2);
    EXPECT_EQ(source->counters()[CameraCount::lost_transfers], 4U);
    EXPECT_EQ(source->counters()[CameraCount::transfers], 6U);
    EXPECT_THAT(heard.events,
                ElementsAre(event(0), event(1), event(2), event(5), event(6), event(9)));
}

TEST_F(Ros2SourceTest, APublisherThatDoesNotCountItsMessagesHasNoGaps) {
    EventPublisher publisher{name_};
    const auto source = open(publisher, message(0));
    const auto parser = source->make_parser();
    for (const std::uint64_t k : {1, 2, 3}) {
        EventPublisher::Message uncounted = message(k);
        uncounted.seq = 0;
        publisher.publish(uncounted);
    }
    const Heard heard = read(*source, *parser, 4);
    EXPECT_EQ(heard.gaps, 0);
    EXPECT_THAT(heard.events, ElementsAre(event(0), event(1), event(2), event(3)));
    EXPECT_EQ(source->counters()[CameraCount::lost_transfers], 0U);
}

TEST_F(Ros2SourceTest, EndsWithItsPublisherOrWaitsForTheNext) {
    for (const bool reconnect : {false, true}) {
        auto publisher = std::make_unique<EventPublisher>(name_);
        const auto source = open(*publisher, message(0), {.settings = {}, .reconnect = reconnect});
        const auto parser = source->make_parser();
        publisher->publish(message(1));
        publisher->wait_until_taken();
        publisher.reset();
        EXPECT_EQ(read(*source, *parser, 2).events.size(), 2U) << "what it sent is not lost";
        if (!reconnect) {
            EXPECT_THAT(error_of([&] { read(*source, *parser, 1); }),
                        HasSubstr("its publisher went away"));
            continue;
        }
        // The next one is less reliable, and counts from 0.
        publisher = std::make_unique<EventPublisher>(name_, false);
        auto waiting = std::async(std::launch::async, [&] { return read(*source, *parser, 1); });
        publisher->wait_for_readers(1);
        EventPublisher::Message next = message(500);
        next.seq = 0;
        publisher->publish(next);
        const Heard heard = waiting.get();
        EXPECT_EQ(heard.gaps, 1);
        EXPECT_THAT(heard.events, ElementsAre(event(500)));
        EXPECT_EQ(source->counters()[CameraCount::reconnects], 1U);
    }
}

TEST_F(Ros2SourceTest, OfTwoPublishersTheNewOneIsRead) {
    EventPublisher old{name_};
    const auto source = open(old, message(0));
    const auto parser = source->make_parser();
    EventPublisher fresh{name_};
    fresh.wait_for_readers(1);
    fresh.publish(message(10));
    EXPECT_THAT(read(*source, *parser, 2).events, ElementsAre(event(0), event(10)));
    old.publish(message(11));
    fresh.publish(message(11));
    fresh.publish(message(12));
    EXPECT_THAT(read(*source, *parser, 2).events, ElementsAre(event(11), event(12)));
    EXPECT_EQ(source->counters()[CameraCount::lost_transfers], 0U) << "the new one counts anew";
}

TEST_F(Ros2SourceTest, WhenTheNewOfTwoPublishersEndsTheOtherIsReadAgain) {
    EventPublisher old{name_};
    const auto source = open(old, message(0));
    const auto parser = source->make_parser();
    auto fresh = std::make_unique<EventPublisher>(name_);
    fresh->wait_for_readers(1);
    fresh->publish(message(10));
    EXPECT_THAT(read(*source, *parser, 2).events, ElementsAre(event(0), event(10)));
    fresh->wait_until_taken();
    fresh.reset();
    // Until it is known that the new one has ended, the other's messages are left out.
    std::uint64_t k = 10;
    RawPacket packet;
    do old.publish(message(++k));
    while (source->read(packet) != ReadStatus::data);
    EXPECT_TRUE(packet.gap_before);
    old.publish(message(++k));
    Batch batch;
    parser->resync();
    parser->parse(packet.bytes, batch);
    while (batch.events.empty() || batch.events.back() != event(k))
        if (source->read(packet) == ReadStatus::data) {
            EXPECT_FALSE(packet.gap_before);
            parser->parse(packet.bytes, batch);
        }
    const std::uint64_t first = k + 1 - batch.events.size();
    for (std::size_t i = 0; i < batch.events.size(); ++i)
        EXPECT_EQ(batch.events[i], event(first + i)) << i;
    EXPECT_EQ(source->counters()[CameraCount::reconnects], 0U);
}

TEST_F(Ros2SourceTest, WhenAReliablePublisherEndsALessReliableOneIsRead) {
    auto reliable = std::make_unique<EventPublisher>(name_);
    EventPublisher other{name_, false};
    const auto source = open(*reliable, message(0));
    const auto parser = source->make_parser();
    EXPECT_THAT(read(*source, *parser, 1).events, ElementsAre(event(0)));
    reliable.reset();
    std::uint64_t k = 0;
    RawPacket packet;
    do other.publish(message(++k));
    while (source->read(packet) != ReadStatus::data);
    EXPECT_TRUE(packet.gap_before);
}

TEST_F(Ros2SourceTest, StopsWhileItWaits) {
    EventPublisher publisher{name_};
    const auto source = open(publisher, message(0));
    RawPacket packet;
    ASSERT_EQ(source->read(packet), ReadStatus::data);
    source->stop();
    EXPECT_EQ(source->read(packet), ReadStatus::end);
}

TEST_F(Ros2SourceTest, SaysWhatThereIsWhenNothingComes) {
    EventPublisher other{own_name("/other/events")};
    EXPECT_THAT(error_of([&] { open_ros2_source(name_ + "?wait=2s", {}); }),
                testing::AllOf(HasSubstr("expected a publisher, found none in 2000 ms"),
                               HasSubstr(own_name("/other/events"))));
    EventPublisher silent{name_};
    EXPECT_THAT(error_of([&] { open_ros2_source(name_ + "?wait=1s", {}); }),
                HasSubstr("its publisher sent nothing in 1000 ms"));
    EXPECT_THAT(
        error_of([&] { open_ros2_source(name_, {.settings = {}, .give_up = [] { return true; }}); },
                 ErrorKind::failed),
        HasSubstr("stopped before the first message"));
}

TEST_F(Ros2SourceTest, SaysWhatItCannotRead) {
    EventPublisher publisher{name_};
    const auto error_for = [&](const std::function<void(EventPublisher::Message&)>& change) {
        EventPublisher::Message bad = message(0);
        change(bad);
        return error_of([&] { open(publisher, bad); });
    };
    EXPECT_THAT(error_for([](auto& m) { m.encoding = "trigger"; }),
                HasSubstr("expected encoding evt3, libcaer, libcaer_cmp or mono, found 'trigger'"));
    EXPECT_THAT(error_for([](auto& m) { m.big_endian = true; }), HasSubstr("big-endian"));
    EXPECT_THAT(error_for([](auto& m) { m.width = 0; }), HasSubstr("found 0x48"));
    EXPECT_THAT(error_for([](auto& m) { m.height = 5000; }), HasSubstr("found 64x5000"));
}

TEST_F(Ros2SourceTest, AChangeOfSizeEndsIt) {
    EventPublisher publisher{name_};
    const auto source = open(publisher, message(0));
    const auto parser = source->make_parser();
    EventPublisher::Message other = message(1);
    other.width = 128;
    publisher.publish(other);
    EXPECT_THAT(error_of([&] { read(*source, *parser, 3); }),
                HasSubstr("expected 64x48 mono as before, found 128x48 mono"));
}

TEST_F(Ros2SourceTest, WithReconnectItWaitsUntilTheSizeIsAsItWas) {
    std::vector<std::string> warnings;
    const CameraOptions options = reconnecting(warnings);
    auto publisher = std::make_unique<EventPublisher>(name_);
    const auto source = open(*publisher, message(0), options);
    const auto parser = source->make_parser();
    EXPECT_THAT(read(*source, *parser, 1).events, ElementsAre(event(0)));
    publisher.reset();
    publisher = std::make_unique<EventPublisher>(name_);
    publisher->wait_for_readers(1);
    for (const std::uint64_t k : {1, 2, 3}) {
        EventPublisher::Message other = message(k);
        other.width = 128;
        publisher->publish(other);
    }
    publisher->publish(message(4));
    const Heard heard = read(*source, *parser, 1);
    EXPECT_EQ(heard.gaps, 1);
    EXPECT_THAT(heard.events, ElementsAre(event(4)));
    EXPECT_THAT(warnings,
                ElementsAre(HasSubstr("expected 64x48 mono as before, found 128x48 mono")));
}

TEST_F(Ros2SourceTest, ATopicOfAnotherTypeIsRefusedOrWaitedPast) {
    {
        const EventPublisher images{name_, true, kImageType};
        EXPECT_THAT(error_of([&] { open_ros2_source(name_ + "?wait=60s", {}); }),
                    HasSubstr("expected a topic of type event_camera_msgs/msg/EventPacket, found "
                              "sensor_msgs/msg/Image"));
        EventPublisher publisher{name_};
        EXPECT_EQ(open(publisher, message(0))->info().width, 64) << "one of the right type beside";
    }
    std::vector<std::string> warnings;
    const CameraOptions options = reconnecting(warnings);
    auto publisher = std::make_unique<EventPublisher>(name_);
    const auto source = open(*publisher, message(0), options);
    const auto parser = source->make_parser();
    EXPECT_EQ(read(*source, *parser, 1).events.size(), 1U);
    publisher.reset();
    const EventPublisher images{name_, true, kImageType};
    RawPacket packet;
    while (warnings.empty()) EXPECT_EQ(source->read(packet), ReadStatus::timeout);
    EXPECT_THAT(warnings.front(), HasSubstr("found sensor_msgs/msg/Image"));
    publisher = std::make_unique<EventPublisher>(name_);
    publisher->wait_for_readers(1);
    publisher->publish(message(1));
    EXPECT_THAT(read(*source, *parser, 1).events, ElementsAre(event(1)));
    EXPECT_EQ(source->counters()[CameraCount::reconnects], 1U);
}

#ifdef EVENTIDE_FASTDDS_PEER
/// An EventPacket in CDR, from the other vendor's writer.
TEST_F(Ros2SourceTest, ReadsAPublisherOfFastDds) {
    CdrWriter cdr;
    cdr.number(std::int32_t(kStamp / 1'000'000'000));
    cdr.number(std::uint32_t{0});
    cdr.text("camera");
    cdr.number(std::uint32_t{48});
    cdr.number(std::uint32_t{64});
    cdr.number(std::uint64_t{0});  // seq
    cdr.number(std::uint64_t{0});  // time_base
    cdr.text("mono");
    cdr.number(std::uint8_t{0});
    std::vector<std::uint8_t> payload;
    for (const std::byte b : bytes_of({mono(0, 3, 4, true), mono(5'000, 5, 6, false)}))
        payload.push_back(std::uint8_t(b));
    cdr.octets(payload);
    const auto message = cdr.finish();
    TempFolder temp;
    write_text(temp / "packet.cdr", {message.begin(), message.end()});
    const Process peer{{EVENTIDE_FASTDDS_PEER, "publish", name_, temp / "packet.cdr"}};
    const auto source = open_ros2_source(name_ + "?wait=60s", {});
    const auto parser = source->make_parser();
    EXPECT_THAT(read(*source, *parser, 2).events,
                ElementsAre(Event{from_us(kStamp / 1000), 3, 4, Polarity::on},
                            Event{from_us(kStamp / 1000 + 5), 5, 6, Polarity::off}));
}
#endif

}  // namespace
}  // namespace eventide::test
