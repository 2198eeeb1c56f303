// Connections of the live page: taken, given a thread each, and ended, all of them, when it is
// over. cpp-httplib reads requests and writes answers; sockets and threads are ours, because its
// own queue has no bound and its accept loop does not say why a port cannot be had.
#pragma once

#include "pipeline/sinks/http/http_address.h"

#include <httplib.h>

#include <atomic>
#include <list>
#include <mutex>
#include <thread>

namespace eventide {

class HttpServer final : private httplib::Server {
public:
    /// Where one more connects, the one that has waited longest without sending its request is
    /// closed; where all have sent theirs, the new one is told 503 and closed.
    static constexpr std::size_t kMaxConnections = 64;

    /// Called for each request, on its connection's thread; also at the same time. `head` sees all,
    /// before their body is read, and returns whether it has answered; of the others `post` gets
    /// those that are POSTs to post_path, with their body.
    struct Answers {
        std::function<bool(const httplib::Request&, httplib::Response&)> head;
        std::string post_path;
        std::function<void(const httplib::Request&, httplib::Response&)> post;
    };

    /// Listens from now on; connections wait until start(). Throws Error: usage for a host that
    /// is not known, failed where the port is in use or not ours to take.
    HttpServer(const HttpAddress& address, Answers answers);
    ~HttpServer() override;
    HttpServer(const HttpServer&) = delete;
    HttpServer& operator=(const HttpServer&) = delete;

    void start();
    /// Ends all connections, and is done when their threads are. Answers that still go on must end
    /// by themselves soon; whoever reads slowly is cut off. Any thread, any number of times.
    void stop() noexcept;

    const HttpAddress& address() const { return address_; }  ///< with the port that was given
    std::size_t connections() const;                         ///< being served

private:
    struct Worker {
        int file = -1;
        bool answers = false;    // its request has come, and the answer is not yet complete
        bool gives_way = false;  // it was ended for another one
        std::atomic<bool> done{false};
        std::jthread thread;
    };
    void accept_all();
    void take(int file);
    bool end_oldest_silent();
    void begin_answer(Worker& worker);
    void end_answer(Worker& worker);
    void serve(Worker& worker) noexcept;
    void reap();

    HttpAddress address_;
    int listening_ = -1, wake_ = -1;
    mutable std::mutex mutex_;  // guards workers_ and what each one has but its thread
    std::list<Worker> workers_;
    std::atomic<bool> stopping_{false};
    std::mutex ending_;  // one stop() at a time
    std::jthread accepting_;
};

}  // namespace eventide
