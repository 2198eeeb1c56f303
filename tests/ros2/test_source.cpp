// A ROS 2 driver as a source: what is published is what is parsed.
#include "tests/ros2/image_cdr.h"
#include "tests/ros2/source_test.h"
#include "tests/support/holdings.h"
#include "tests/system/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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
