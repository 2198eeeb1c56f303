#include "pipeline/sinks/http/connection.h"

#include "src/core/number_text.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace eventide {

namespace {

using Clock = std::chrono::steady_clock;

/// The events that came, 0 when none did until then.
short wait_for(int file, short events, Clock::time_point until) {
    for (;;) {
        const auto left =
            std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
        pollfd waited{file, events, 0};
        const int ready = poll(&waited, 1, int(std::clamp<long long>(left, 0, 60'000)));
        if (ready > 0) return waited.revents;
        if (ready == 0 && left <= 0) return 0;
        if (ready < 0 && errno != EINTR) return POLLERR;
    }
}

void describe(const sockaddr_storage& address, socklen_t size, std::string& ip, int& port) {
    char host[NI_MAXHOST], service[NI_MAXSERV];
    if (getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, host, sizeof host, service,
                    sizeof service, NI_NUMERICHOST | NI_NUMERICSERV) != 0)
        return;
    ip = host;
    port = number_in<int>(service).value_or(0);
}

}  // namespace

bool Connection::is_readable() const {
    return begin_ < end_ || (wait_for(file_, POLLIN, Clock::now()) & POLLIN) != 0;
}

bool Connection::is_writable() const {
    const short came = wait_for(file_, POLLOUT | POLLRDHUP, Clock::now() + kWriteTime);
    return (came & POLLOUT) != 0 && (came & (POLLRDHUP | POLLHUP | POLLERR)) == 0;
}

bool Connection::fill() {
    for (;;) {
        if (received_ >= kMaxRequestBytes) return false;
        const ssize_t count =
            recv(file_, buffer_.data(), std::min(buffer_.size(), kMaxRequestBytes - received_), 0);
        if (count > 0) {
            begin_ = 0;
            end_ = std::size_t(count);
            received_ += end_;
            return true;
        }
        if (count == 0) return false;
        if (errno == EINTR) continue;
        if (errno != EAGAIN && errno != EWOULDBLOCK) return false;
        if (wait_for(file_, POLLIN, until_) == 0) return false;
    }
}

/// 0 also where time or room is up: httplib then takes the request for ended.
ssize_t Connection::read(char* into, std::size_t size) {
    if (begin_ == end_ && !fill()) return 0;
    const std::size_t count = std::min(size, end_ - begin_);
    std::copy_n(buffer_.data() + begin_, count, into);
    begin_ += count;
    return ssize_t(count);
}

ssize_t Connection::write(const char* from, std::size_t size) {
    for (;;) {
        const ssize_t count = send(file_, from, size, MSG_NOSIGNAL);
        if (count >= 0) return count;
        if (errno == EINTR) continue;
        if (errno != EAGAIN && errno != EWOULDBLOCK) return -1;
        const short came = wait_for(file_, POLLOUT, Clock::now() + kWriteTime);
        if ((came & POLLOUT) == 0) return -1;
    }
}

void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    if (getpeername(file_, reinterpret_cast<sockaddr*>(&address), &size) == 0)
        describe(address, size, ip, port);
}

void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    if (getsockname(file_, reinterpret_cast<sockaddr*>(&address), &size) == 0)
        describe(address, size, ip, port);
}

void Connection::end() {
    if (shutdown(file_, SHUT_WR) != 0) return;
    const Clock::time_point until = Clock::now() + std::chrono::seconds{1};
    std::size_t thrown_away = 0;
    while (thrown_away < kMaxRequestBytes * 4) {
        const ssize_t count = recv(file_, buffer_.data(), buffer_.size(), 0);
        if (count > 0) {
            thrown_away += std::size_t(count);
            continue;
        }
        if (count == 0) return;
        if (errno == EINTR) continue;
        if (errno != EAGAIN && errno != EWOULDBLOCK) return;
        if (wait_for(file_, POLLIN, until) == 0) return;
    }
}

}  // namespace eventide
