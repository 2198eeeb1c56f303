// A live page with frames on it, and clients of it.
#pragma once

#include "pipeline/sinks/http/http_sink.h"
#include "tests/pipeline/sinks/frames.h"

#include <gtest/gtest.h>
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

namespace eventide::test {

constexpr std::chrono::seconds kLong{30};  // a busy machine's

/// Asks again and again; false where it was not so in time.
inline bool becomes_true(const std::function<bool()>& condition) {
    for (const auto until = std::chrono::steady_clock::now() + kLong;
         std::chrono::steady_clock::now() < until;
         std::this_thread::sleep_for(std::chrono::milliseconds{1}))
        if (condition()) return true;
    return condition();
}

/// Listens at a free port of this machine.
inline std::unique_ptr<HttpSink> open_page(HttpSettings settings = {}) {
    settings.address.port = 0;
    return open_http(std::move(settings));
}

/// Writes ramp frames into a sink, one after the other, until it is told to end.
class Frames {
public:
    explicit Frames(HttpSink& sink, int width = 64, int height = 48)
        : thread_{[this, &sink, width, height](const std::stop_token& stop) {
              for (int n = 0; !stop.stop_requested(); ++n) {
                  sink.write(ramp_frame(width, height, n, odd_time(n)));
                  ++written_;
                  std::this_thread::sleep_for(std::chrono::microseconds{500});
              }
          }} {}
    int written() const { return written_; }

private:
    std::atomic<int> written_{0};
    std::jthread thread_;
};

inline httplib::Client client_of(const HttpSink& sink) {
    httplib::Client client{sink.address().host, sink.address().port};
    client.set_read_timeout(kLong);
    client.set_connection_timeout(kLong);
    return client;
}

/// A connection whose every byte is ours.
class RawClient {
public:
    explicit RawClient(const HttpSink& sink);
    ~RawClient();
    RawClient(RawClient&& other) noexcept : file_{std::exchange(other.file_, -1)} {}
    RawClient& operator=(RawClient&&) = delete;

    void send(const std::string& text) const;
    /// Nothing more is sent; answers are still heard.
    void finish() const;
    /// Until `size` bytes came or the other end closed.
    std::string receive(std::size_t size) const;
    std::string receive_all() const { return receive(std::size_t(-1)); }
    /// Gone without a goodbye.
    void drop();

private:
    int file_;
};

/// "GET /path HTTP/1.1" with a Host that is right, and what else was given.
std::string request(const std::string& line, const std::string& headers = "",
                    const std::string& body = "");
/// 0 where it is no answer.
int status_of(const std::string& answer);

}  // namespace eventide::test
