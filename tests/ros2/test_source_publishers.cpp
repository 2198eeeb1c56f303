// Publishers that end, come back, are several, or publish something else.
#include "tests/ros2/source_test.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

}  // namespace
}  // namespace eventide::test
