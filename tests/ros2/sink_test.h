// A sink of topics, and those who read them.
#pragma once

#include "pipeline/ros2/ros2_sink.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/ros2/topics.h"
#include "tests/support/keep_in.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace eventide::test {

using Image = sensor_msgs_msg_dds__Image_;
using Info = sensor_msgs_msg_dds__CameraInfo_;
using Compressed = sensor_msgs_msg_dds__CompressedImage_;

/// A sink on a name of its own. Its frames have the sensor's time since 1970 as their stamp.
class Ros2SinkTest : public testing::Test {
protected:
    std::unique_ptr<Sink> open(const std::string& keys = {}, bool with_sigma = true) {
        Ros2SinkSettings settings;
        settings.name = parse_ros2_sink_name(name_ + keys);
        settings.with_sigma = with_sigma;
        settings.say = keep_in(said_);
        settings.warn = settings.say;
        return open_ros2_sink(std::move(settings));
    }
    static Frame frame(int n) { return ramp_frame(8, 4, n, odd_time(n)); }
    static std::int64_t stamp_us(const std_msgs_msg_dds__Header_& header) {
        return std::int64_t{header.stamp.sec} * 1'000'000 + header.stamp.nanosec / 1000;
    }
    template <typename T>
    static std::vector<T> pixels(const Image& image) {
        std::vector<T> values(image.data._length / sizeof(T));
        std::memcpy(values.data(), image.data._buffer, image.data._length);
        return values;
    }

    const std::string name_ =
        own_name("/" + std::string{testing::UnitTest::GetInstance()->current_test_info()->name()});
    std::vector<std::string> said_;
    TempFolder temp_;
};

}  // namespace eventide::test
