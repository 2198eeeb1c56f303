// A ROS 2 driver in software, and what is read of it.
#pragma once

#include "drivers/ros2/ros2_source.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "tests/ros2/topics.h"
#include "tests/support/error_of.h"
#include "tests/support/keep_in.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

namespace eventide::test {

/// "mono": `ns` after the message's time base.
inline std::uint64_t mono(std::uint32_t ns, unsigned x, unsigned y, bool on) {
    return ns | std::uint64_t{x} << 32 | std::uint64_t{y} << 48 | std::uint64_t{on} << 63;
}

inline std::vector<std::byte> bytes_of(const std::vector<std::uint64_t>& words) {
    std::vector<std::byte> bytes;
    for (const std::uint64_t word : words) append_little(bytes, word);
    return bytes;
}

inline constexpr std::int64_t kStamp = 1'700'000'000'000'000'000;  // ns

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
        options.warn = keep_in(warnings);
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
        return test::error_of(call, kind);
    }

    const std::string name_ =
        own_name("/" + std::string{testing::UnitTest::GetInstance()->current_test_info()->name()});
};

}  // namespace eventide::test
