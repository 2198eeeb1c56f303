// DAVIS USB words <-> events, APS frames, IMU samples, triggers (docs/protocols.md A.9 to
// A.11).
#pragma once

#include "src/codec/inivation/davis_frame.h"
#include "src/codec/inivation/davis_imu.h"
#include "src/codec/inivation/davis_sensor.h"
#include "src/codec/inivation/inivation_clock.h"
#include "src/codec/parser.h"
#include "src/codec/whole_words.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace eventide {

/// Parses the 16-bit little-endian words of DAVIS240 and DAVIS346 (logic 18).
///
/// Time is 64 bits here, so the 2^31 us overflow of older readers does not exist. A timestamp reset
/// sets the time back to zero on the device; here it goes on: the time before the reset is kept as
/// an offset, so that the stream never steps back, and a Trigger of kind timestamp_reset says where
/// it happened.
class DavisParser final : public Parser {
public:
    explicit DavisParser(const DavisSensor& sensor);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

    void arrives(HostTime at) override { clock_.arrives(at, damage_); }

private:
    static constexpr std::size_t kStretchWords = 256;  ///< read at a time by plain_words()

    /// What bits 15-12 of a word make of it, as masks; none of the three where `last` is negative.
    struct WordKind {
        std::int64_t time = 0, row = 0;  ///< -1 a timestamp, -1 a row
        std::int64_t event = 0;          ///< 1 an event
        std::int64_t last = -1;          ///< the largest value of bits 11-0
    };

    void parse_words(std::span<const std::byte> bytes, Batch& into);
    template <bool kSwapped>
    std::size_t plain_words(std::span<const std::byte> bytes, Batch& into);
    void word(std::uint16_t word, Batch& into);
    void misc8(std::uint16_t data);
    void begin_frame(DavisFrameAssembler::Shutter shutter);
    void note_loss(bool is_lost);
    void special(std::uint16_t data, Batch& into);
    void event(std::uint16_t x, Polarity polarity, Batch& into);
    void trigger(Trigger::Kind kind, std::uint8_t source, Batch& into);
    void timestamp_reset(Batch& into);

    DavisSensor sensor_;
    DavisFrameAssembler frame_;
    DavisImuAssembler imu_;
    Damage damage_;
    WholeWords<2> words_;
    IniVationClock<15> clock_;
    std::uint16_t y_ = 0;
    bool y_known_ = false;
    std::array<WordKind, 16> kinds_;
    std::array<Event, kStretchWords + 1> found_;  ///< scratch of plain_words()
};

}  // namespace eventide
