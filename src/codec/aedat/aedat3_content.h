// What the records in packets of AEDAT 3 say.
#pragma once

#include "src/codec/aedat/aedat3_packet.h"
#include "src/codec/event_validator.h"
#include "src/codec/told_time.h"
#include "src/core/damage.h"
#include "src/core/event.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace eventide {

/// Events that a timestamp reset, or another file joined to the first, sets back in time begin a
/// new stream.
class Aedat3Content {
public:
    /// Gives the upper left `width` x `height` px of the sensor, which has `rows`; what lies
    /// outside is out_of_range. `lower_left`: the file counts rows from the sensor's lowest.
    Aedat3Content(bool lower_left, int rows, int width, int height);

    /// A packet begins, whose records take() gets next.
    void begin(const Aedat3Packet& packet);
    /// Whole records of the packet.
    void take(const Aedat3Packet& packet, std::span<const std::byte> records, Batch& into);
    /// What follows is of another file.
    void join() { is_joined_ = true; }
    void finish(Batch& into);
    void resync();
    /// As Parser::clock().
    std::optional<std::int64_t> newest_us() const { return told_.newest_us(); }
    Damage& damage() { return damage_; }
    const Damage& damage() const { return damage_; }

private:
    void take_one(Aedat3Type type, std::span<const std::byte> record, Batch& into);
    void take_events(std::span<const std::byte> records, Batch& into);
    const std::byte* take_plain_events(const std::byte* record, const std::byte* end, Batch& into);
    void take_event(const std::byte* record, Batch& into);
    void take_special(const std::byte* record, Batch& into);
    void take_frame(std::span<const std::byte> record, Batch& into);
    bool may_begin_anew() const { return was_reset_ || is_joined_; }
    void begin_anew_after_reset(std::int64_t t_us, Batch& into);

    bool lower_left_;
    std::uint64_t rows_;  ///< px
    EventValidator validator_;
    Damage damage_;

    std::int64_t base_us_ = 0;  ///< what the packet's overflow adds
    bool was_reset_ = false;    ///< since the last packet of events
    bool is_joined_ = false;    ///< another file begins, since the last packet of events
    ToldTime told_;
};

}  // namespace eventide
