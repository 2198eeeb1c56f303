// Bytes on their way from a source to a parser.
#pragma once

#include "src/core/sensor_time.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace eventide {

struct RawPacket {
    std::vector<std::byte> bytes;
    HostTime arrived{};
    std::uint64_t sequence = 0;  ///< counts packets read, also lost ones: a jump is a loss
    bool gap_before = false;     ///< bytes were lost between the packet before and this one
    /// Beside gap_before: the device was opened again, so that its clock may start at another time.
    bool reopened = false;
};

}  // namespace eventide
