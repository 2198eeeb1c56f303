// data -> the words of a DVXplorer's two boards: the inverse of its parsers
// (docs/protocols.md A.12).
#pragma once

#include "src/codec/inivation/dvxplorer_sensor.h"
#include "src/core/event.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace eventide::testing_support {

/// Codes of the BMI160's ranges, as in its registers: accelerometer 2 g << code, gyroscope
/// 2000 deg/s >> code.
struct ImuRanges {
    int accel = 1, gyro = 2;
};

/// Column and row of an event on the chip.
std::pair<int, int> device_axes(const Event& event, const DvxplorerSensor& sensor);

/// The reset marker where there was one, then everything in the order of time.
std::vector<std::byte> fx3_words(const Batch& scene, const DvxplorerSensor& sensor,
                                 const ImuRanges& ranges, bool after_reset = true);

/// What a Mini sends on its two endpoints: words, and messages each of which comes after so many
/// bytes of them.
struct MiniStream {
    struct Message {
        std::size_t after = 0;
        std::vector<std::byte> bytes;
    };
    std::vector<std::byte> words;
    std::vector<Message> messages;
};

/// One frame per time; its events in the order of the columns. An IMU sample comes right behind the
/// reference of its millisecond, whose time it so gets.
MiniStream mini_stream(const Batch& scene, const DvxplorerSensor& sensor, const ImuRanges& ranges);

}  // namespace eventide::testing_support
