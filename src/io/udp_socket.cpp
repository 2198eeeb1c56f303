// UDP by POSIX sockets.
#include "src/io/udp_socket.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/system_words.h"

#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

namespace eventide {

namespace {

using Addresses = std::unique_ptr<addrinfo, void (*)(addrinfo*)>;

Addresses addresses_of(const UdpName& name, int flags) {
    addrinfo wanted{};
    wanted.ai_family = AF_UNSPEC;
    wanted.ai_socktype = SOCK_DGRAM;
    wanted.ai_flags = flags | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    const int result = ::getaddrinfo(name.host.c_str(), name.port.c_str(), &wanted, &found);
    if (result != 0)
        throw Error(ErrorKind::device,
                    name.text() + ": cannot be found: " + ::gai_strerror(result));
    return {found, ::freeaddrinfo};
}

/// The first address with which `connect` (bind or connect) succeeds.
template <typename Use>
int open_with(const UdpName& name, const Addresses& addresses, const char* doing, Use use) {
    int error = 0;
    for (const addrinfo* each = addresses.get(); each != nullptr; each = each->ai_next) {
        const int made =
            ::socket(each->ai_family, each->ai_socktype | SOCK_CLOEXEC, each->ai_protocol);
        if (made >= 0 && use(made, each->ai_addr, each->ai_addrlen) == 0) return made;
        error = errno;
        if (made >= 0) ::close(made);
    }
    throw Error(ErrorKind::device, name.text() + ": cannot " + doing + ": " + system_words(error));
}

[[noreturn]] void refuse(const std::string& text) {
    throw Error(ErrorKind::usage,
                "udp:" + text + ": expected udp://HOST:PORT, with ?KEY=VALUE&... behind it");
}

}  // namespace

UdpName UdpName::parse(const std::string& text) {
    if (!text.starts_with("//")) refuse(text);
    const std::size_t question = std::min(text.find('?'), text.size());
    const std::string address = text.substr(2, question - 2);
    const std::size_t colon = address.rfind(':');
    if (colon == address.npos || colon == 0) refuse(text);
    UdpName name;
    name.host = address.substr(0, colon);
    name.port = address.substr(colon + 1);
    // getaddrinfo() takes the lower 16 bits of a larger one.
    if (!number_in<std::uint16_t>(name.port))
        throw Error(ErrorKind::usage,
                    "udp:" + text + ": expected a port from 0 to 65535, found '" + name.port + "'");
    const bool brackets = name.host.starts_with('[') && name.host.ends_with(']');
    if (brackets) name.host = name.host.substr(1, name.host.size() - 2);
    // Those of an IPv6 address alone.
    if (name.host.find_first_of("[]") != name.host.npos ||
        (brackets && name.host.find(':') == name.host.npos))
        refuse(text);
    for (std::size_t at = question + 1; at < text.size();) {
        const std::size_t end = std::min(text.find('&', at), text.size());
        const std::string pair = text.substr(at, end - at);
        const std::size_t equals = pair.find('=');
        if (equals == pair.npos || equals == 0) refuse(text);
        name.values.emplace_back(pair.substr(0, equals), pair.substr(equals + 1));
        at = end + 1;
    }
    return name;
}

std::string UdpName::text() const {
    const bool brackets = host.find(':') != host.npos;
    return "udp://" + (brackets ? "[" + host + "]" : host) + ":" + port;
}

UdpSocket UdpSocket::listening(const UdpName& name) {
    UdpSocket made{open_with(name, addresses_of(name, AI_PASSIVE), "listen there", ::bind),
                   name.text()};
    const int yes = 1, room = 1 << 22;  // bytes: bursts of a fast camera; the system may give less
    ::setsockopt(made.socket_, SOL_SOCKET, SO_RXQ_OVFL, &yes, sizeof yes);
    ::setsockopt(made.socket_, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    return made;
}

UdpSocket UdpSocket::sending(const UdpName& name) {
    // Connecting there succeeds, and every datagram is lost.
    if (number_in<std::uint16_t>(name.port) == 0)
        throw Error(ErrorKind::usage,
                    name.text() + ": expected a port from 1 to 65535 to send to, found 0");
    return {open_with(name, addresses_of(name, 0), "send there", ::connect), name.text()};
}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      name_(std::move(other.name_)),
      dropped_(other.dropped_),
      dropped_told_(other.dropped_told_),
      refused_(other.refused_) {}

UdpSocket::~UdpSocket() {
    if (socket_ >= 0) ::close(socket_);
}

void UdpSocket::fail(const char* doing) const {
    throw Error(ErrorKind::device, name_ + ": cannot " + doing + ": " + system_words(errno));
}

std::uint16_t UdpSocket::port() const {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    if (::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
        fail("be asked for its port");
    // The same place in both kinds of address.
    return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

std::optional<std::size_t> UdpSocket::receive(std::span<std::byte> into,
                                              std::chrono::milliseconds at_most) {
    pollfd watched{socket_, POLLIN, 0};
    const int ready = ::poll(&watched, 1, int(at_most.count()));
    if (ready < 0 && errno != EINTR) fail("be waited for");
    if (ready <= 0) return {};
    iovec place{into.data(), into.size()};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(std::uint32_t))];
    msghdr message{};
    message.msg_iov = &place;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const ssize_t n = ::recvmsg(socket_, &message, MSG_DONTWAIT);
    if (n < 0) {
        if (errno == EAGAIN || errno == EINTR || errno == ECONNREFUSED) return {};
        fail("be read");
    }
    for (cmsghdr* each = CMSG_FIRSTHDR(&message); each != nullptr;
         each = CMSG_NXTHDR(&message, each))
        if (each->cmsg_level == SOL_SOCKET && each->cmsg_type == SO_RXQ_OVFL)
            std::memcpy(&dropped_, CMSG_DATA(each), sizeof dropped_);
    return std::size_t(n);
}

std::uint64_t UdpSocket::take_lost() {
    const std::uint32_t lost = dropped_ - dropped_told_;
    dropped_told_ = dropped_;
    return lost;
}

bool UdpSocket::send(std::span<const std::byte> datagram) {
    // That one before was refused is told, once, in place of sending this one.
    for (;; ++refused_)
        if (const auto n = ::send(socket_, datagram.data(), datagram.size(), MSG_NOSIGNAL);
            n >= 0 || errno != ECONNREFUSED)
            return n == ssize_t(datagram.size());
}

std::uint64_t UdpSocket::take_refused() {
    int error = 0;
    socklen_t size = sizeof error;
    ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size);
    return std::exchange(refused_, 0) + (error == ECONNREFUSED ? 1 : 0);
}

}  // namespace eventide
