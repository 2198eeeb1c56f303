#include "pipeline/sinks/http/http_server.h"

#include "pipeline/sinks/http/connection.h"
#include "pipeline/sinks/http/listening_socket.h"
#include "src/core/error.h"
#include "src/io/system_words.h"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <utility>

namespace eventide {

namespace {

constexpr std::string_view kTooMany =
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nContent-Length: 21\r\n"
    "Retry-After: 1\r\nConnection: close\r\n\r\ntoo many connections\n";

/// What is on its way to a viewer that is slow: few frames, so that those it sees are new.
constexpr int kSendBytes = 256 * 1024;

void prepare(int file) {
    const int yes = 1;
    setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    setsockopt(file, SOL_SOCKET, SO_SNDBUF, &kSendBytes, sizeof kSendBytes);
}

/// Viewers' encodings take the processor's time that the run leaves.
void stand_back() {
    constexpr int kNice = 5;
    setpriority(PRIO_PROCESS, id_t(gettid()), kNice);
}

/// Never waits.
void turn_away(int file) {
    [[maybe_unused]] const auto sent =
        send(file, kTooMany.data(), kTooMany.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    ::close(file);
}

}  // namespace

HttpServer::HttpServer(const HttpAddress& address, Answers answers) : address_{address} {
    listening_ = listen_at(address_);
    wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (wake_ < 0) {
        const int error = errno;
        ::close(listening_);
        throw Error(ErrorKind::failed, "--out http: cannot wait: " + system_words(error));
    }
    svr_sock_ = listening_;
    set_payload_max_length(Connection::kMaxRequestBytes);
    set_pre_routing_handler([head = std::move(answers.head)](const httplib::Request& request,
                                                             httplib::Response& response) {
        return head(request, response) ? HandlerResponse::Handled : HandlerResponse::Unhandled;
    });
    Post(answers.post_path, std::move(answers.post));
}

HttpServer::~HttpServer() {
    stop();
    ::close(listening_);
    ::close(wake_);
}

void HttpServer::start() {
    accepting_ = std::jthread{[this] {
        pthread_setname_np(pthread_self(), "eventide-http");
        accept_all();
    }};
}

std::size_t HttpServer::connections() const {
    const std::lock_guard lock{mutex_};
    std::size_t serving = 0;
    for (const Worker& worker : workers_) serving += worker.done ? 0U : 1U;
    return serving;
}

void HttpServer::accept_all() {
    bool exhausted = false;  // of descriptors or memory: it has to get better by itself
    while (!stopping_) {
        pollfd waited[]{{wake_, POLLIN, 0}, {listening_, POLLIN, 0}};
        poll(waited, exhausted ? 1 : 2, exhausted ? 50 : 1000);
        exhausted = false;
        reap();
        if ((waited[1].revents & POLLIN) == 0 || stopping_) continue;
        const int file = accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
        if (file >= 0)
            take(file);
        else
            exhausted = errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM;
    }
}

void HttpServer::take(int file) {
    prepare(file);
    if (connections() >= kMaxConnections && !end_oldest_silent()) return turn_away(file);
    const std::lock_guard lock{mutex_};
    try {
        Worker& worker = workers_.emplace_back();
        worker.file = file;
        worker.thread = std::jthread{[this, &worker] { serve(worker); }};
    } catch (...) {  // no thread, or no memory
        if (!workers_.empty() && !workers_.back().thread.joinable()) workers_.pop_back();
        turn_away(file);
    }
}

/// Clients send their request at once: who holds a place without one keeps others out. False where
/// nobody does.
bool HttpServer::end_oldest_silent() {
    std::list<Worker> ended;  // and joined, without the lock
    const std::lock_guard lock{mutex_};
    const auto oldest = std::ranges::find_if(
        workers_, [](const Worker& worker) { return !worker.done && !worker.answers; });
    if (oldest == workers_.end()) return false;
    oldest->gives_way = true;
    ::shutdown(oldest->file, SHUT_RDWR);
    ended.splice(ended.end(), workers_, oldest);
    return true;
}

/// Throws where the connection has just been ended for another one.
void HttpServer::begin_answer(Worker& worker) {
    const std::lock_guard lock{mutex_};
    if (worker.gives_way) throw Error(ErrorKind::failed, "live page: the connection gave way");
    worker.answers = true;
}

void HttpServer::end_answer(Worker& worker) {
    const std::lock_guard lock{mutex_};
    worker.answers = false;
}

void HttpServer::serve(Worker& worker) noexcept {
    pthread_setname_np(pthread_self(), "eventide-page");
    stand_back();
    int file = -1;
    {
        const std::lock_guard lock{mutex_};
        file = worker.file;
    }
    try {
        Connection connection{file};
        // One request for each connection: whatever follows a request that was refused unread is
        // never taken for another one.
        bool closed = false;
        process_request(connection, true, closed, [&](httplib::Request& request) {
            begin_answer(worker);
            request.ranges.clear();  // no part of a frame is of use; players ask for them
        });
        end_answer(worker);
        if (!stopping_) connection.end();
    } catch (...) {  // of one viewer, who sees his connection closed
    }
    const std::lock_guard lock{mutex_};
    ::close(std::exchange(worker.file, -1));
    worker.done = true;
}

/// Accepting thread, and after it stop().
void HttpServer::reap() {
    std::list<Worker> finished;
    {
        const std::lock_guard lock{mutex_};
        for (auto worker = workers_.begin(); worker != workers_.end();) {
            const auto next = std::next(worker);
            if (worker->done) finished.splice(finished.end(), workers_, worker);
            worker = next;
        }
    }
}

void HttpServer::stop() noexcept {
    const std::lock_guard one{ending_};
    stopping_ = true;
    svr_sock_ = INVALID_SOCKET;  // httplib's streams end
    const std::uint64_t word = 1;
    [[maybe_unused]] const auto written = ::write(wake_, &word, sizeof word);
    if (accepting_.joinable()) accepting_.join();
    const auto end_all = [&](int how) {
        const std::lock_guard lock{mutex_};
        for (Worker& worker : workers_)
            if (worker.file >= 0) ::shutdown(worker.file, how);
    };
    end_all(SHUT_RD);  // whoever waits for a request
    constexpr std::chrono::milliseconds kMax{250}, kStep{2};
    for (auto waited = kStep; waited < kMax && connections() > 0; waited += kStep)
        std::this_thread::sleep_for(kStep);
    end_all(SHUT_RDWR);  // whoever writes to one that does not read
    workers_.clear();    // joins
}

}  // namespace eventide
