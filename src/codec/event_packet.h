// event_camera_msgs/EventPacket of ROS drivers, in its four encodings.
#pragma once

#include "src/codec/event_validator.h"
#include "src/codec/parser.h"
#include "src/codec/prophesee/evt3.h"
#include "src/codec/whole_words.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace eventide {

/// Facts from ros-event-camera/event_camera_codecs and libcaer_driver.
enum class EventPacketEncoding {
    evt3,  ///< the words of Prophesee's cameras; a message begins anywhere in their stream
    /// 8 bytes an event, as libcaer has it: u32 valid bit 0, polarity 1, y 2-16, x 17-31; i32 us
    /// after the message's time base, which fall where their 31 bits wrap.
    libcaer,
    /// 16-bit words like EVT3, along columns: bits 15-12 say what, 11-0 hold it. 0 and 1 bits 12-23
    /// and 0-11 of the us after the time base, 2 the column, 3 a row and (bit 11) polarity, an
    /// event; 4 a row and polarity, from which 5 counts: bits 0-7, an event for each set one.
    libcaer_cmp,
    /// 8 bytes an event: u64 with ns after the time base 0-31, x 32-47, y 48-62, polarity 63.
    mono
};

/// Empty for any other.
std::optional<EventPacketEncoding> event_packet_encoding(std::string_view name);

/// What stands before the payload of a message.
struct EventPacketHeader {
    static constexpr std::size_t kBytes = 24;

    std::uint64_t time_base_ns = 0;  ///< of the message
    std::int64_t stamp_ns = 0;       ///< header.stamp: ROS time of its first event
};

/// A message as EventPacketParser reads it: "EVPK", u32 bytes of payload, u64 time base, i64 stamp,
/// the payload. Little endian.
void append_event_packet(const EventPacketHeader& header, std::span<const std::byte> payload,
                         std::vector<std::byte>& out);

/// All times are ROS's. libcaer's time bases are; sensor times of the others are shifted so that
/// the first event is at its message's stamp. After a gap a shift is set anew only where it is more
/// than kMaxShift off: then the camera, or its driver, has begun anew. Where that sets the time
/// back, a Trigger of kind timestamp_reset says so. A time that leaps is believed when the next
/// packet does not lie before it.
class EventPacketParser final : public Parser {
public:
    static constexpr SensorDuration kMaxShift{1'000'000};
    static constexpr std::size_t kLargestPayload = std::size_t{1} << 28;

    /// Size in px.
    EventPacketParser(EventPacketEncoding encoding, int width, int height);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    std::size_t take_header(std::span<const std::byte> bytes);
    void begin_packet();
    void end_packet(Batch& into);
    void drop();
    void take_payload(std::span<const std::byte> bytes, Batch& into);
    void take_libcaer(const std::byte* event, Batch& into);
    void take_mono(const std::byte* event, Batch& into);
    void take_compressed(std::uint16_t word, Batch& into);
    void move_high(std::int64_t value);
    void move_low(std::int64_t value);
    void take_rows(unsigned mask, unsigned y, bool on, Batch& into);
    void pass_evt3(Batch& into);
    void shift_to_stamp(std::int64_t t_us);
    void begin_anew_after_gap(std::int64_t t_us, Batch& into);
    void note_newest();
    void take_event(std::int64_t t_us, unsigned x, unsigned y, bool on, Batch& into);

    static constexpr unsigned kNowhere = 1U << 16;

    EventPacketEncoding encoding_;
    EventValidator validator_;  ///< of all but EVT3, which has its own rules
    Damage damage_;
    std::array<std::byte, EventPacketHeader::kBytes> header_{};
    std::size_t header_bytes_ = 0;  ///< read of the next one
    bool lost_ = false;             ///< looking for the next header, the damage is counted
    std::size_t rest_ = 0;          ///< bytes of payload to come
    WholeWords<2> words_;
    WholeWords<8> events_;
    std::int64_t newest_us_ = kNoTime, last_event_us_ = kNoTime;
    std::optional<std::int64_t> shift_us_;  ///< of sensor times
    bool after_gap_ = true;                 ///< nothing has told a time since: it may be any
    Evt3Parser evt3_;
    Damage evt3_damage_;  ///< of evt3_, what is in damage_ already
    Batch evt3_batch_;    ///< of this packet, in the sensor's time

    // Of this packet.
    std::int64_t base_ns_ = 0, stamp_us_ = 0;
    std::int64_t high_ = 0, low_ = 0;  ///< libcaer_cmp: 4096 us and us; libcaer: wraps and us
    unsigned x_ = kNowhere, y_ = kNowhere;
    bool on_ = false;
};

}  // namespace eventide
