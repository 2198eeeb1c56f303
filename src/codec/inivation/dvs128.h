// DVS128 USB words -> events and sync triggers (docs/protocols.md A.12).
#pragma once

#include "src/codec/inivation/inivation_clock.h"
#include "src/codec/parser.h"
#include "src/codec/whole_words.h"

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
    void arrives(HostTime at) override { clock_.arrives(at, damage_); }
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    void record(std::uint16_t address, std::uint16_t time, Batch& into);

    Damage damage_;
    WholeWords<4> records_;
    IniVationClock<14> clock_;
};

}  // namespace eventide
