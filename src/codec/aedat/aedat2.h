// AEDAT 2.0: 32-bit addresses and times, big-endian, of a DVS128 or a DAVIS (docs/protocols.md
// D.1).
#pragma once

#include "src/codec/aedat/aedat1.h"
#include "src/codec/aedat/aedat2_frame.h"
#include "src/codec/aedat/aedat2_imu.h"
#include "src/codec/aedat/aedat_parser.h"
#include "src/codec/stream.h"

namespace eventide {

/// A DAVIS240 for itself, as its images have half the range of the others'.
enum class Aedat2Sensor : std::uint8_t { dvs128, davis, davis240 };

struct Aedat2Header {
    StreamHeader stream;
    Aedat2Sensor sensor = Aedat2Sensor::dvs128;
};

/// The sensor is the one the AEChip line names. Without one (older recorders): the stated size
/// says, else addresses of 16 bits mean a DVS128. Throws Error (input) when none of this tells.
Aedat2Header read_aedat2_header(std::span<const std::byte> first_bytes, int stated_width = 0,
                                int stated_height = 0);

/// The data of records, whatever the sensor.
class Aedat2Content {
public:
    /// As Aedat2Parser.
    Aedat2Content(Aedat2Sensor sensor, int width, int height, bool one_is_on, int shown_width,
                  int shown_height);

    void take(const AedatRecord& record, std::int64_t t_us, Batch& into, Damage& damage);
    void end_of_file(Batch& into, Damage& damage);
    void resync();

private:
    void take_davis(std::uint32_t address, std::int64_t t_us, Batch& into, Damage& damage);
    void add_event(std::uint32_t address, std::int64_t t_us, Batch& into, Damage& damage);
    bool is_shown(std::uint32_t x, std::uint32_t y) const {
        return x < shown_width_ && y < shown_height_;
    }

    Aedat2Sensor sensor_;
    std::uint32_t width_, height_;  ///< px, of the chip
    std::uint32_t shown_width_, shown_height_;
    Dvs128Events dvs128_;
    Aedat2FrameAssembler frame_;
    Aedat2ImuAssembler imu_;
    std::optional<std::int64_t> last_event_us_;
};

class Aedat2Parser final : public AedatParser<std::uint32_t, Aedat2Content> {
public:
    /// `width` x `height` px of the chip. `one_is_on`: what bit 0 of a DVS128's address means (see
    /// OpenOptions). `shown`: of a sensor stated as smaller, its upper left part; 0 for all.
    Aedat2Parser(Aedat2Sensor sensor, int width, int height, bool one_is_on = false,
                 int shown_width = 0, int shown_height = 0)
        : AedatParser(Aedat2Content(sensor, width, height, one_is_on, shown_width, shown_height)) {}
};

}  // namespace eventide
