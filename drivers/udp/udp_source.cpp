// Datagrams as packets.
#include "drivers/udp/udp_source.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"

#include <string>

namespace eventide {

namespace {

constexpr std::chrono::milliseconds kLongestWait{20};  // how late stop() may be heard
constexpr std::chrono::milliseconds kGathered{1};      // datagrams of one packet
constexpr std::size_t kEnoughBytes = 256 << 10;
constexpr int kMostAtOnce = 1024;

void read_size(const UdpName& name, const std::string& text, SensorInfo& info) {
    const auto [width, height] = size_in(text).value_or(std::pair{0, 0});
    if (width < 1 || height < 1 || width > kLargestSensorSide || height > kLargestSensorSide)
        throw Error(
            ErrorKind::usage,
            name.text() + ": size: expected WIDTHxHEIGHT such as 640x480, found '" + text + "'");
    info.width = width;
    info.height = height;
}

}  // namespace

UdpSource::UdpSource(const UdpName& name)
    : socket_(UdpSocket::listening(name)), datagram_(kLargestDatagram) {
    info_.name = name.text();
    for (const auto& [key, value] : name.values) {
        const auto named = udp_records_named(value);
        if (key == "size")
            read_size(name, value, info_);
        else if (key != "format")
            throw Error(ErrorKind::usage,
                        name.text() + ": expected size=WxH and format=, found '" + key + "'");
        else if (named)
            records_ = *named;
        else
            throw Error(ErrorKind::usage,
                        name.text() + ": format: expected t64, t32 or spif, found '" + value + "'");
    }
    if (info_.width == 0)
        throw Error(ErrorKind::usage,
                    name.text() +
                        ": expected the sensor's size, which datagrams do not tell, "
                        "such as " +
                        name.text() + "?size=640x480");
    info_.format = "udp";
}

/// What comes within a millisecond is one packet: a fast camera fills thousands of datagrams a
/// second, and the pipeline's buffers are for as many packets as bridge a burst.
ReadStatus UdpSource::read(RawPacket& into) {
    into.bytes.clear();
    auto n = socket_.receive(datagram_, kLongestWait);
    const HostTime until = std::chrono::steady_clock::now() + kGathered;
    for (int taken = 1; n && !stopped_; ++taken) {
        take(std::span{datagram_}.first(*n), into);
        if (taken == kMostAtOnce || into.bytes.size() >= kEnoughBytes) break;
        n = socket_.receive(datagram_, std::chrono::milliseconds{0});
        if (!n && std::chrono::steady_clock::now() < until)
            n = socket_.receive(datagram_, kGathered);
    }
    into.arrived = std::chrono::steady_clock::now();
    if (stopped_) {
        into.bytes.clear();
        return ReadStatus::end;
    }
    if (into.bytes.empty()) return ReadStatus::timeout;
    const std::uint64_t lost = socket_.take_lost();
    count(CameraCount::lost_transfers, lost);
    into.gap_before = lost > 0;
    count(CameraCount::bytes, into.bytes.size());
    return ReadStatus::data;
}

void UdpSource::take(std::span<const std::byte> datagram, RawPacket& into) {
    const std::size_t whole = whole_udp_records(records_, datagram);
    if (whole != datagram.size()) count(CameraCount::cut_transfers);
    if (whole == 0) return;
    into.bytes.insert(into.bytes.end(), datagram.begin(), datagram.begin() + std::ptrdiff_t(whole));
    count(CameraCount::transfers);
}

std::unique_ptr<Parser> UdpSource::make_parser() const {
    return std::make_unique<UdpRecordsParser>(records_, info_.width, info_.height);
}

std::unique_ptr<Camera> open_udp_source(std::string_view which, const CameraOptions& options) {
    if (!options.settings.empty())
        throw Error(
            ErrorKind::usage,
            "camera settings: expected a camera that has some, found udp:" + std::string(which));
    return std::make_unique<UdpSource>(UdpName::parse(std::string(which)));
}

}  // namespace eventide
