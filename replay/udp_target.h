// Events sent over UDP as they come.
#pragma once

#include "replay/convert.h"
#include "src/codec/udp_records.h"
#include "src/io/udp_socket.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// A datagram holds kEventsAtATime events at most: below what Ethernet carries in one piece. What
/// the system has no room for, or nobody takes, is lost and counted.
class UdpTarget final : public ConvertTarget {
public:
    static constexpr std::size_t kEventsAtATime = 100;

    /// `to`: "udp://HOST:PORT", with ?format=t64|t32|spif. Throws Error: usage for the name or
    /// coordinates that the format does not hold, device where there is no such host.
    UdpTarget(const std::string& to, const StreamHeader& header);

    const FormatHolds& holds() const override;
    void write(const Batch& batch) override;
    void finish() override;
    std::uint64_t bytes_written() const override { return bytes_; }
    std::uint64_t lost() const override { return lost_; }

private:
    void refuse_negative_times(std::span<const Event> events) const;

    UdpName name_;
    UdpRecords records_ = UdpRecords::t64;
    UdpSocket socket_;
    std::vector<std::byte> datagram_;
    std::uint64_t bytes_ = 0, lost_ = 0;
};

}  // namespace eventide
