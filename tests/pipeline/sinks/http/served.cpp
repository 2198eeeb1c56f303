#include "tests/pipeline/sinks/http/served.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>

namespace eventide::test {

RawClient::RawClient(const HttpSink& sink) : file_{socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)} {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(std::uint16_t(sink.address().port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval timeout{kLong.count(), 0};
    setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    if (connect(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
        throw std::runtime_error("cannot connect");
}

RawClient::~RawClient() {
    if (file_ >= 0) ::close(file_);
}

void RawClient::send(const std::string& text) const {
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t count = ::send(file_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
        if (count <= 0) return;  // the other end has heard enough
        sent += std::size_t(count);
    }
}

void RawClient::finish() const {
    shutdown(file_, SHUT_WR);
}

std::string RawClient::receive(std::size_t size) const {
    std::string text;
    char part[4096];
    while (text.size() < size) {
        const ssize_t count = recv(file_, part, std::min(sizeof part, size - text.size()), 0);
        if (count <= 0) break;
        text.append(part, std::size_t(count));
    }
    return text;
}

void RawClient::drop() {
    const linger at_once{1, 0};
    setsockopt(file_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    ::close(std::exchange(file_, -1));
}

std::string request(const std::string& line, const std::string& headers, const std::string& body) {
    return line + " HTTP/1.1\r\nHost: 127.0.0.1\r\n" + headers + "\r\n" + body;
}

int status_of(const std::string& answer) {
    return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9, 3)) : 0;
}

}  // namespace eventide::test
