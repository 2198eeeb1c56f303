// DVXplorer Mini and Micro (CX3 board): USB words and messages -> events, IMU samples
// (docs/protocols.md A.12; the messages: libcaer src/dvxplorer.c, debugTranslator).
#pragma once

#include "src/codec/inivation/davis_imu.h"
#include "src/codec/inivation/dvxplorer_sensor.h"
#include "src/codec/parser.h"
#include "src/codec/whole_words.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace eventide {

/// A Mini says some things beside its data, on an endpoint of its own. This makes words of such a
/// message (1 to 64 bytes, in place), so that it travels among those of the data: its length behind
/// a bit that no word of the camera has, then its bytes, padded.
void frame_mini_message(std::vector<std::byte>& message);

/// 32-bit words of the CX3 board (Mini, Micro). The sensor is read out frame by frame: the first
/// column of a frame says its time, as microseconds after the last reference, which comes every
/// millisecond; within a frame the columns rise. A column that does not, or a frame before the
/// last, tells of a loss, and what follows is left out until the next reference.
class DvxplorerMiniParser final : public Parser {
public:
    explicit DvxplorerMiniParser(const DvxplorerSensor& sensor)
        : sensor_(sensor), imu_(imu_of(sensor)) {}

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    /// Where the first reference after a loss is far from what the host's clock says the camera
    /// began anew, and time goes on by the host's.
    void arrives(HostTime at) override { arrived_ = at; }
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    void word(std::uint32_t word, Batch& into);
    void reference(std::int64_t us);
    void settle(std::int64_t us);
    void forget_reference(DamageReason why);
    void column(std::uint32_t word);
    void group(int first_row, std::uint32_t mask, bool off, Batch& into);
    void begin_message(std::uint32_t header);
    void message_word(std::uint32_t word, Batch& into);
    void message(std::span<const std::byte> bytes, Batch& into);

    DvxplorerSensor sensor_;
    DavisImuAssembler imu_;
    Damage damage_;
    WholeWords<4> words_;
    std::int64_t base_ = 0;        ///< us, of reference 0
    std::int64_t reference_ = -1;  ///< us since base_; -1: not known since the start or a loss
    std::int64_t time_ = 0;        ///< us
    std::optional<HostTime> arrived_, told_at_;  ///< of these words; of those that told time_
    int column_ = -1;  ///< -1: no frame has begun since the start or a loss
    std::array<std::byte, 64> message_{};
    std::size_t message_bytes_ = 0, message_read_ = 0;  ///< equal: no message has begun
};

}  // namespace eventide
