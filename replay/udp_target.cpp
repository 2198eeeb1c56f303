// Events as datagrams.
#include "replay/udp_target.h"

#include "src/core/error.h"

#include <algorithm>
#include <string>

namespace eventide {

namespace {

constexpr std::string_view kScheme = "udp:";

[[noreturn]] void refuse(const std::string& to, const std::string& key, const std::string& value) {
    throw Error(ErrorKind::usage,
                to + ": expected format=t64, t32 or spif, found '" + key + "=" + value + "'");
}

}  // namespace

UdpTarget::UdpTarget(const std::string& to, const StreamHeader& header)
    : name_(UdpName::parse(to.substr(kScheme.size()))), socket_(UdpSocket::sending(name_)) {
    for (const auto& [key, value] : name_.values) {
        const auto named = key == "format" ? udp_records_named(value) : std::nullopt;
        if (!named) refuse(to, key, value);
        records_ = *named;
    }
    constexpr int kLargest = 32768;  // 15 bits
    if (records_ != UdpRecords::t64 && std::max(header.width, header.height) > kLargest)
        throw Error(ErrorKind::usage, to + ": expected a sensor of at most 32768 px each way");
}

const FormatHolds& UdpTarget::holds() const {
    static const FormatHolds only_events{.clock_resets = true};
    return only_events;
}

/// Of 64 bits without a sign; those of 32 wrap.
void UdpTarget::refuse_negative_times(std::span<const Event> events) const {
    if (records_ != UdpRecords::t64) return;
    const auto negative =
        std::ranges::find_if(events, [](const Event& event) { return to_us(event.t) < 0; });
    if (negative != events.end())
        throw Error(ErrorKind::usage, name_.text() + ": expected times from 0 us, found " +
                                          std::to_string(to_us(negative->t)) + " us");
}

void UdpTarget::write(const Batch& batch) {
    const std::span<const Event> events = batch.events;
    refuse_negative_times(events);
    for (std::size_t i = 0; i < events.size(); i += kEventsAtATime) {
        datagram_.clear();
        append_udp_records(records_, events.subspan(i, std::min(kEventsAtATime, events.size() - i)),
                           datagram_);
        if (socket_.send(datagram_))
            bytes_ += datagram_.size();
        else
            ++lost_;
    }
    lost_ += socket_.take_refused();
}

void UdpTarget::finish() {
    lost_ += socket_.take_refused();
}

}  // namespace eventide
