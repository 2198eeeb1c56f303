// A service manager's end of sd_notify(3).
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>

namespace eventide::test {

class ManagerSocket {
public:
    /// Throws where no socket can be made at `path`, or at the abstract name "@name".
    explicit ManagerSocket(const std::string& path)
        : socket_{socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)} {
        sockaddr_un at{};
        at.sun_family = AF_UNIX;
        std::strncpy(at.sun_path, path.c_str(), sizeof at.sun_path - 1);
        if (path.starts_with('@')) at.sun_path[0] = '\0';
        // Behind an abstract name every further byte would be of the name.
        const auto length = socklen_t(offsetof(sockaddr_un, sun_path) + path.size());
        if (bind(socket_, reinterpret_cast<sockaddr*>(&at), length) != 0)
            throw std::runtime_error(path + ": no socket there");
    }
    ~ManagerSocket() { close(socket_); }
    ManagerSocket(const ManagerSocket&) = delete;
    ManagerSocket& operator=(const ManagerSocket&) = delete;

    /// The next message that has come, or "nothing".
    std::string next() {
        char text[512];
        const ssize_t n = recv(socket_, text, sizeof text, 0);
        return n < 0 ? "nothing" : std::string(text, std::size_t(n));
    }

private:
    int socket_;
};

}  // namespace eventide::test
