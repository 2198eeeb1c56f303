// AEDAT4: packets of events, frames, IMU samples and triggers, each packed on its own
// (docs/protocols.md D.3).
#pragma once

#include "src/codec/aedat4/aedat4_compression.h"
#include "src/codec/aedat4/aedat4_header.h"
#include "src/codec/aedat4/aedat4_records.h"
#include "src/codec/aedat4/aedat4_table.h"
#include "src/codec/event_validator.h"
#include "src/codec/parser.h"
#include "src/codec/told_time.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace eventide {

/// Reads the packets after the header, of one camera. At most one packet is held back. After a
/// packet that makes no sense, and after resync(), the next beginning of a packet is searched for.
/// A file table that is missing or does not fit counts as bad_table and is not needed.
class Aedat4Parser final : public Parser {
public:
    /// Size in px. Packets of more than `largest` bytes, unpacked, count as damaged.
    Aedat4Parser(const Aedat4Header& header, int width, int height,
                 std::size_t largest = kLargestAedat4Packet);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    enum class State { packets, searching, table };

    /// Takes what it can from the front and returns how much; 0 when it needs need_ bytes.
    std::size_t step(std::span<const std::byte> bytes, Batch& into);
    std::size_t search(std::span<const std::byte> bytes);
    std::size_t read_packet(std::span<const std::byte> bytes, Batch& into);
    std::size_t read_table(std::span<const std::byte> bytes);
    std::size_t drop_packet(std::size_t bytes, DamageReason reason);
    bool may_be_packet(std::span<const std::byte> bytes) const;
    bool may_be_table(std::span<const std::byte> bytes, std::size_t at) const;
    bool take_payload(std::int32_t stream, std::span<const std::byte> payload, Batch& into);
    void take_root(Aedat4Kind kind, const FlatTable& table, Batch& into);
    void note_reset(const Trigger& trigger);
    void check_table();
    void run(std::span<const std::byte>& bytes, Batch& into);

    Aedat4Header header_;
    EventValidator validator_;
    Damage damage_;
    Aedat4Unpacker unpacker_;
    std::array<std::optional<std::int32_t>, 4> chosen_;  ///< stream per kind
    bool all_streams_;  ///< the header names none: the packets themselves say what they are

    State state_ = State::packets;
    std::vector<std::byte>
        pending_;           ///< a packet whose end has not come; in State::table the table
    std::size_t need_ = 0;  ///< bytes of pending_ that step() needs
    int failed_in_a_row_ = 0;
    bool missed_packets_ = false;            ///< what was read is not all there was
    std::optional<std::uint64_t> position_;  ///< in the file; empty after resync()
    Aedat4PacketTrace trace_;
    ToldTime told_;
    std::optional<std::int64_t> anew_us_;  ///< a trigger said that the clock was reset to this
};

}  // namespace eventide
