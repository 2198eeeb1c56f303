// A connection as cpp-httplib reads and writes it, with a bound on everything: how long a request
// may take to come, how many bytes it may have, how long a viewer may take nothing.
#pragma once

#include <httplib.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <string>

namespace eventide {

/// The descriptor is borrowed and does not block.
class Connection final : public httplib::Stream {
public:
    static constexpr std::chrono::seconds kRequestTime{5};  ///< for all of a request
    static constexpr std::chrono::seconds kWriteTime{5};    ///< without a byte taken
    static constexpr std::size_t kMaxRequestBytes = 24U * 1024;

    explicit Connection(int file) : file_{file} {}

    bool is_readable() const override;
    /// Waits for room; false where the other end went away or took nothing for kWriteTime.
    bool is_writable() const override;
    ssize_t read(char* into, std::size_t size) override;
    ssize_t write(const char* from, std::size_t size) override;
    void get_remote_ip_and_port(std::string& ip, int& port) const override;
    void get_local_ip_and_port(std::string& ip, int& port) const override;
    socket_t socket() const override { return file_; }

    /// Nothing more will be written: what the other end still sends is thrown away for a moment,
    /// because closing before it is read would take our answer back.
    void end();

private:
    bool fill();

    const int file_;
    const std::chrono::steady_clock::time_point until_ =
        std::chrono::steady_clock::now() + kRequestTime;
    std::array<char, 4096> buffer_{};
    std::size_t begin_ = 0, end_ = 0, received_ = 0;
};

}  // namespace eventide
