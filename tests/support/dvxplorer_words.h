// data -> the words of a DVXplorer's two boards: the inverse of its parsers
// (drivers-and-formats.md A.12).
#pragma once

#include "src/codec/dvxplorer.h"
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

/// The reset marker, then everything in the order of time.
std::vector<std::byte> fx3_words(const Batch& scene, const DvxplorerSensor& sensor,
                                 const ImuRanges& ranges);

/// One frame per time; its events in the order of the columns.
std::vector<std::byte> mini_words(const std::vector<Event>& events, const DvxplorerSensor& sensor);

}  // namespace eventide::testing_support
