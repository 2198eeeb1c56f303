// Records of UDP datagrams.
#include "src/codec/udp_records.h"

#include "src/codec/nearest_time.h"
#include "src/core/byte_order.h"
#include "src/core/sensor_limits.h"

#include <algorithm>

namespace eventide {

namespace {

constexpr std::uint32_t kNoTime = 1U << 31;
constexpr std::int64_t kFarUs = 1'000'000;
constexpr auto kLatestUs = std::uint64_t(kFarthestUs);

}  // namespace

std::optional<UdpRecords> udp_records_named(std::string_view name) {
    if (name == "t64" || name == "t64_x16_y16_on8") return UdpRecords::t64;
    if (name == "t32" || name == "t32_x16_y15_on1") return UdpRecords::t32;
    if (name == "spif") return UdpRecords::spif;
    return std::nullopt;
}

void append_udp_records(UdpRecords kind, std::span<const Event> events,
                        std::vector<std::byte>& out) {
    for (const Event& event : events) {
        const auto t = std::uint64_t(to_us(event.t));
        const auto on = unsigned(event.polarity);
        switch (kind) {
            case UdpRecords::t64:
                append_little(out, t);
                append_little(out, event.x);
                append_little(out, event.y);
                out.push_back(std::byte(on));
                break;
            case UdpRecords::t32:
                append_little(out, std::uint32_t(t));
                append_little(out, event.x);
                append_little(out, std::uint16_t(unsigned(event.y) << 1 | on));
                break;
            case UdpRecords::spif:
                append_little(
                    out, std::uint32_t((event.x & 0x7FFFU) << 16 | on << 15 | (event.y & 0x7FFFU)));
                append_little(out, std::uint32_t(t));
                break;
        }
    }
}

std::size_t whole_udp_records(UdpRecords kind, std::span<const std::byte> datagram) {
    if (kind == UdpRecords::t64) return datagram.size() / 13 * 13;
    if (kind == UdpRecords::t32) return datagram.size() / 8 * 8;
    std::size_t at = 0;
    while (datagram.size() - at >= 4) {
        const bool timed = (load_little<std::uint32_t>(datagram.data() + at) & kNoTime) == 0;
        if (timed && datagram.size() - at < 8) break;
        at += timed ? 8 : 4;
    }
    return at;
}

/// Of the one in work, as far as its first bytes tell.
std::size_t UdpRecordsParser::record_bytes() const {
    if (kind_ == UdpRecords::t64) return 13;
    if (kind_ == UdpRecords::t32) return 8;
    if (n_ < 4) return 4;
    return (load_little<std::uint32_t>(record_.data()) & kNoTime) == 0 ? 8 : 4;
}

void UdpRecordsParser::parse(std::span<const std::byte> bytes, Batch& into) {
    while (!bytes.empty()) {
        const std::size_t n = std::min(record_bytes() - n_, bytes.size());
        std::copy_n(bytes.begin(), n, record_.begin() + std::ptrdiff_t(n_));
        n_ += n;
        bytes = bytes.subspan(n);
        if (n_ < record_bytes()) continue;
        n_ = 0;
        take_record(into);
    }
}

void UdpRecordsParser::take_record(Batch& into) {
    const std::byte* at = record_.data();
    if (kind_ == UdpRecords::t64) {
        const auto t = load_little<std::uint64_t>(at);
        if (t > kLatestUs) return damage_.count(DamageReason::bad_record);
        return take(std::int64_t(t), load_little<std::uint16_t>(at + 8),
                    load_little<std::uint16_t>(at + 10), at[12] != std::byte{0}, into);
    }
    if (kind_ == UdpRecords::t32) {
        const auto y_on = load_little<std::uint16_t>(at + 6);
        return take(unwrapped(load_little<std::uint32_t>(at)), load_little<std::uint16_t>(at + 4),
                    y_on >> 1, (y_on & 1) != 0, into);
    }
    const auto word = load_little<std::uint32_t>(at);
    const std::int64_t t =
        (word & kNoTime) != 0 ? arrival_us_ : unwrapped(load_little<std::uint32_t>(at + 4));
    take(t, word >> 16 & 0x7FFF, word & 0x7FFF, (word >> 15 & 1) != 0, into);
}

/// Near the times that were believed, as stamps that lie would lead from one range into the next,
/// and as much later as the host's clock says: nothing is sent while nothing moves.
std::int64_t UdpRecordsParser::unwrapped(std::uint32_t stamp) const {
    const auto newest = validator_.newest_us();
    if (!newest) return stamp;
    return nearest_time(stamp, *newest + arrival_us_ - newest_arrival_us_);
}

void UdpRecordsParser::take(std::int64_t t_us, unsigned x, unsigned y, bool on, Batch& into) {
    const auto newest = validator_.newest_us();
    early_ = newest && t_us < *newest - kFarUs ? early_ + 1 : 0;
    if (early_ >= kEventsOfAnother) {
        validator_.finish(into, damage_);
        validator_.resync(damage_);
        early_ = 0;
        into.triggers.push_back({from_us(t_us), Trigger::Kind::timestamp_reset, 0});
    }
    validator_.add(t_us, x, y, on, into, damage_);
    if (validator_.newest_us() != newest) newest_arrival_us_ = arrival_us_;
}

void UdpRecordsParser::finish(Batch& into) {
    if (n_ > 0) damage_.count(DamageReason::truncated);
    n_ = 0;
    validator_.finish(into, damage_);
}

/// Datagrams hold whole records: those behind a lost one are as good as any.
void UdpRecordsParser::resync() {
    n_ = 0;
}

void UdpRecordsParser::arrives(HostTime t) {
    if (!first_arrival_) first_arrival_ = t;
    arrival_us_ = std::chrono::duration_cast<SensorDuration>(t - *first_arrival_).count();
}

std::optional<SensorTime> UdpRecordsParser::clock() const {
    const auto newest = validator_.newest_us();
    return newest ? std::optional(from_us(*newest)) : std::nullopt;
}

}  // namespace eventide
