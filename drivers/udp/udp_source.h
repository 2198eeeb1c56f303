// Events that another program sends over UDP.
#pragma once

#include "drivers/devices.h"
#include "src/codec/udp_records.h"
#include "src/io/udp_socket.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace eventide {

/// A packet is the datagrams that come within a millisecond, in their order. None of the formats
/// numbers them: lost are those that the system says it had no room for, and a gap is before the
/// packet that they would have been in.
class UdpSource final : public Camera {
public:
    /// size=WxH has to be given, format= is t64 unless told otherwise. Throws Error: usage for the
    /// name, device where the address cannot be listened at.
    explicit UdpSource(const UdpName& name);

    const SensorInfo& info() const override { return info_; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override { stopped_ = true; }
    std::unique_ptr<Parser> make_parser() const override;

    std::uint16_t port() const { return socket_.port(); }

private:
    static constexpr std::size_t kLargestDatagram = 65536;
    void take(std::span<const std::byte> datagram, RawPacket& into);

    SensorInfo info_;
    UdpRecords records_ = UdpRecords::t64;
    UdpSocket socket_;
    std::vector<std::byte> datagram_;
    std::atomic<bool> stopped_{false};
};

/// `which` is what follows "udp:".
std::unique_ptr<Camera> open_udp_source(std::string_view which, const CameraOptions& options);

}  // namespace eventide
