#include "pipeline/sinks/http/listening_socket.h"

#include "src/core/error.h"
#include "src/io/system_words.h"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

namespace eventide {

namespace {

constexpr int kBacklog = 64;

struct FreeAddresses {
    void operator()(addrinfo* list) const { freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

std::string name_of(const HttpAddress& address) {
    return "--out http:" + address.host + ":" + std::to_string(address.port);
}

Addresses look_up(const HttpAddress& address) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    const std::string port = std::to_string(address.port);
    if (const int error = getaddrinfo(address.host.c_str(), port.c_str(), &hints, &found);
        error != 0)
        // Where no name server answers, as while a machine starts, the name may be right.
        throw Error(
            error == EAI_AGAIN || error == EAI_SYSTEM ? ErrorKind::failed : ErrorKind::usage,
            name_of(address) + ": the host is not known: " +
                (error == EAI_SYSTEM ? system_words(errno) : std::string{gai_strerror(error)}));
    return Addresses{found};
}

/// Below 0, and errno, where it cannot be had.
int open_one(const addrinfo& where) {
    const int file = socket(where.ai_family, where.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK,
                            where.ai_protocol);
    if (file < 0) return -1;
    const int yes = 1;
    // A port whose last connections are still being closed is free; one that listens is not.
    setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (bind(file, where.ai_addr, where.ai_addrlen) == 0 && listen(file, kBacklog) == 0)
        return file;
    const int error = errno;
    ::close(file);
    errno = error;
    return -1;
}

int port_of(int file) {
    sockaddr_storage own{};
    socklen_t size = sizeof own;
    getsockname(file, reinterpret_cast<sockaddr*>(&own), &size);
    return ntohs(own.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(own).sin6_port
                                           : reinterpret_cast<sockaddr_in&>(own).sin_port);
}

std::string advice(int error) {
    if (error == EADDRINUSE) return "; another program has it; http:HOST:0 takes any free port";
    if (error == EACCES) return "; ports below 1024 are the system's";
    if (error == EADDRNOTAVAIL) return "; this machine has no such address";
    return "";
}

}  // namespace

int listen_at(HttpAddress& address) {
    const Addresses found = look_up(address);
    int error = 0;
    for (const addrinfo* where = found.get(); where != nullptr; where = where->ai_next) {
        const int file = open_one(*where);
        if (file >= 0) {
            address.port = port_of(file);
            return file;
        }
        error = errno;
    }
    throw Error(ErrorKind::failed,
                name_of(address) + " cannot be opened: " + system_words(error) + advice(error));
}

}  // namespace eventide
