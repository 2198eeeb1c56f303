// UDP sockets: addresses by name, datagrams in and out.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// "//HOST:PORT?KEY=VALUE&KEY=VALUE", as it follows "udp:".
struct UdpName {
    std::string host, port;  ///< host without the brackets of IPv6
    std::vector<std::pair<std::string, std::string>> values;

    /// Throws Error (usage) for what is no such name.
    static UdpName parse(const std::string& text);
    std::string text() const;  ///< "udp://HOST:PORT"
};

class UdpSocket {
public:
    /// Listens at the address; port 0 takes a free one. Throws Error (device) where it is taken or
    /// none of this machine's.
    static UdpSocket listening(const UdpName& name);
    /// Sends to the address. Throws Error: usage for port 0, device where there is no such host.
    static UdpSocket sending(const UdpName& name);

    UdpSocket(UdpSocket&& other) noexcept;
    UdpSocket& operator=(UdpSocket&&) = delete;
    ~UdpSocket();

    std::uint16_t port() const;  ///< of a listening one

    /// Waits for a datagram, at most so long; its size, and empty where none came. Longer ones than
    /// `into` are cut. Throws Error (device).
    std::optional<std::size_t> receive(std::span<std::byte> into,
                                       std::chrono::milliseconds at_most);
    /// Datagrams that the system had no room for since the last call: those before the newest.
    std::uint64_t take_lost();

    /// False where the system had no room.
    bool send(std::span<const std::byte> datagram);
    /// Datagrams sent of which the system has told, since the last call, that nobody listens there.
    std::uint64_t take_refused();

private:
    UdpSocket(int socket, std::string name) : socket_(socket), name_(std::move(name)) {}
    [[noreturn]] void fail(const char* doing) const;
    int socket_;
    std::string name_;
    std::uint32_t dropped_ = 0, dropped_told_ = 0;  // as the system counts, since it was opened
    std::uint64_t refused_ = 0;
};

}  // namespace eventide
