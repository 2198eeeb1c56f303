// DVS128 USB words -> events and sync triggers (drivers-and-formats.md A.12).
#pragma once

#include "src/codec/parser.h"

#include <array>
#include <cstdint>
#include <optional>

namespace eventide {

/// Four bytes each: address (bit 0 polarity, 0 ON; 1-7 x; 8-14 y; 15 external input), 14 bits of
/// time, both little endian. Byte 3 with 0x80 is a wrap of the time, with 0x40 a reset. The sensor
/// is mirrored in x and y.
class Dvs128Parser final : public Parser {
public:
    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    void expect_passed(SensorDuration passed) override { expected_ = time_ + passed.count(); }
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    void record(Batch& into);
    void catch_up(std::int64_t candidate);

    Damage damage_;
    std::array<std::uint8_t, 4> record_{};
    std::size_t filled_ = 0;
    std::int64_t wrap_add_ = 0, time_ = 0;  ///< us
    bool time_known_ = false;
    std::optional<std::int64_t> expected_;
};

}  // namespace eventide
