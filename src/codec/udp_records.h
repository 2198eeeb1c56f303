// Events as AEStream, faery and SpiNNaker's spif send them over UDP, whole records per datagram.
#pragma once

#include "src/codec/event_validator.h"
#include "src/codec/parser.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace eventide {

/// Little endian.
enum class UdpRecords {
    t64,  ///< 13 bytes: u64 us, u16 x, u16 y, u8 on (faery's t64_x16_y16_on8)
    t32,  ///< 8 bytes: u32 us, u16 x, u16 y << 1 | on (faery's t32_x16_y15_on1)
    /// u32: bit 31 no time, 30-16 x, 15 on, 14-0 y; without bit 31 a u32 of us follows.
    spif
};

/// "t64", "t32" or "spif", and faery's names. Empty for any other.
std::optional<UdpRecords> udp_records_named(std::string_view name);

/// Appends the records of the events. Coordinates that do not fit (32767 for y of t32 and x, y of
/// spif) must not come.
void append_udp_records(UdpRecords kind, std::span<const Event> events,
                        std::vector<std::byte>& out);

/// Bytes of the whole records at the front: what a datagram holds beyond them is none.
std::size_t whole_udp_records(UdpRecords kind, std::span<const std::byte> datagram);

/// Times of 32 bits go on where they wrap, behind a silence by the host's clock. Events of spif
/// without a time have that of their arrival, us after the first arrival. Where kEventsOfAnother
/// events in a row lie more than a second before those before them, the sender has begun anew: a
/// Trigger of kind timestamp_reset says so.
class UdpRecordsParser final : public Parser {
public:
    static constexpr int kEventsOfAnother = 16;

    UdpRecordsParser(UdpRecords kind, int width, int height)
        : kind_(kind), validator_(std::uint64_t(width), std::uint64_t(height)) {}

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    void arrives(HostTime t) override;
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    std::size_t record_bytes() const;
    void take_record(Batch& into);
    void take(std::int64_t t_us, unsigned x, unsigned y, bool on, Batch& into);
    std::int64_t unwrapped(std::uint32_t stamp) const;

    UdpRecords kind_;
    EventValidator validator_;
    Damage damage_;
    std::array<std::byte, 13> record_{};
    std::size_t n_ = 0;  ///< of its bytes
    std::optional<HostTime> first_arrival_;
    std::int64_t arrival_us_ = 0;
    std::int64_t newest_arrival_us_ = 0;  ///< of the newest time believed
    int early_ = 0;                       ///< events in a row that lie far before what came
};

}  // namespace eventide
