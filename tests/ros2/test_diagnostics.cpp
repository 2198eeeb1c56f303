// How far the stamps are from the sensor's time, as the run and /diagnostics say it.
#include "pipeline/ros2/diagnostics_topic.h"
#include "tests/ros2/sink_test.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

using testing::HasSubstr;

TEST_F(Ros2SinkTest, TheOffsetOfASensorThatCountsFromItsStartIsSaid) {
    TopicReader image{kImageType, name_ + "/image_raw"};
    const auto sink = open();
    ASSERT_TRUE(image.wait_for_writers(1));
    Frame sent = frame(0);
    sent.t = from_us(1'000);
    sent.window = {from_us(0), from_us(2'000)};
    sent.arrived = std::chrono::steady_clock::now();
    const auto before = std::chrono::system_clock::now();
    sink->write(sent);
    const Image* shown = image.next<Image>();
    ASSERT_NE(shown, nullptr);
    const std::int64_t now_us =
        std::chrono::duration_cast<std::chrono::microseconds>(before.time_since_epoch()).count();
    EXPECT_NEAR(double(stamp_us(shown->header) - now_us), -1'000, 10'000'000);
    ASSERT_EQ(said_.size(), 1U);
    EXPECT_THAT(said_[0], HasSubstr("stamps are the sensor's time + 1"));
}

TEST_F(Ros2SinkTest, DiagnosticsTellTheOffsetOnceAndThenEachSecond) {
    TopicReader diagnostics{kDiagnosticArrayType, "/diagnostics"},
        image{kImageType, name_ + "/image_raw"};
    const auto sink = open("?lazy=yes");
    ASSERT_TRUE(diagnostics.wait_for_writers(1) && image.wait_for_writers(1));
    EXPECT_EQ(diagnostics.writer().user_data,
              "typehash=" + std::string{kDiagnosticArrayType.hash} + ";");
    Frame sent = frame(0);
    const auto send_at = [&](std::int64_t us) {
        sent.t = from_us(us);
        sent.window = {from_us(us - 1000), from_us(us + 1000)};
        sent.arrived = std::chrono::steady_clock::now();
        sink->write(sent);
        const Image* shown = image.next<Image>();
        return shown == nullptr ? 0 : stamp_us(shown->header);
    };
    std::vector<std::int64_t> stamps;
    for (const std::int64_t us : {1'000, 500'000, 900'000, 1'001'000, 1'500'000})
        stamps.push_back(send_at(us));
    for (const std::size_t told : {0U, 3U}) {
        const auto* message = diagnostics.next<diagnostic_msgs_msg_dds__DiagnosticArray_>();
        ASSERT_NE(message, nullptr);
        EXPECT_EQ(stamp_us(message->header), stamps[told]);
        ASSERT_EQ(message->status._length, 1U);
        const auto& status = message->status._buffer[0];
        EXPECT_EQ(status.level, 0);
        EXPECT_EQ(status.name, "eventide: " + name_ + " stamps");
        EXPECT_THAT(status.message, HasSubstr(said_[0].substr(said_[0].find("stamps are"))));
        ASSERT_EQ(status.values._length, 3U);
        EXPECT_STREQ(status.values._buffer[0].key, "offset_s");
        EXPECT_NEAR(std::stod(status.values._buffer[0].value), double(stamps[0] - 1'000) / 1e6,
                    2e-6);
        EXPECT_STREQ(status.values._buffer[2].key, "sensor_time_s");
        EXPECT_STREQ(status.values._buffer[2].value, told == 0 ? "0.001000" : "1.001000");
    }
    EXPECT_EQ(said_.size(), 1U);
}

TEST_F(Ros2SinkTest, WhoComesToTheDiagnosticsWithinASecondIsToldAtOnce) {
    using Diagnostics = diagnostic_msgs_msg_dds__DiagnosticArray_;
    DiagnosticsTopic topic{Participant::join(), name_};
    const auto wait_for_readers = [&](int n) {
        while (topic.writer.readers() != n) std::this_thread::yield();
    };
    std::int64_t stamp = to_us(odd_time(0));
    std::optional<TopicReader> reader{std::in_place, kDiagnosticArrayType, "/diagnostics"};
    wait_for_readers(1);
    topic.tell({.stamp_us = stamp});
    ASSERT_NE(reader->next<Diagnostics>(), nullptr);
    reader.reset();
    wait_for_readers(0);
    topic.tell({.stamp_us = stamp += 1'000});
    reader.emplace(kDiagnosticArrayType, "/diagnostics");
    wait_for_readers(1);
    topic.tell({.stamp_us = stamp += 1'000});
    const auto* late = reader->next<Diagnostics>(std::chrono::seconds{5});
    ASSERT_NE(late, nullptr);
    EXPECT_EQ(stamp_us(late->header), stamp);
}

}  // namespace
}  // namespace eventide::test
