// The handler only writes a byte; a thread that waits for it does the rest.
#include "apps/cli/signals.h"

#include "src/core/error.h"
#include "src/core/second_signal.h"
#include "src/io/system_words.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <string_view>

namespace eventide::app {

namespace {

// What a handler can reach.
std::atomic<int> wake_fd{-1};
FirstSignal first_signal;
static_assert(std::atomic<int>::is_always_lock_free);

void say(std::string_view words) {
    // Not through the logger: it may be what hangs, and no handler may call it.
    [[maybe_unused]] const auto written = write(STDERR_FILENO, words.data(), words.size());
}

extern "C" void handle(int number) {
    const int error = errno;
    switch (first_signal.take(number)) {
        case StopWish::first: {
            [[maybe_unused]] const auto written = write(wake_fd, "s", 1);
            break;
        }
        case StopWish::repeated:
            break;
        case StopWish::second:
            say("\neventide: stopped at once; files may be incomplete\n");
            _exit(128 + number);
    }
    errno = error;
}

sigset_t watched() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGHUP);
    return set;
}

}  // namespace

Signals::Signals() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
        throw Error(ErrorKind::failed, "a pipe for signals cannot be made: " + system_words(errno));
    read_end_ = ends[0];
    write_end_ = ends[1];
    wake_fd = write_end_;
    first_signal.forget();
    const sigset_t set = watched();
    pthread_sigmask(SIG_BLOCK, &set, &mask_before_);
    Action action{};
    action.sa_handler = handle;
    action.sa_mask = set;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, &interrupt_before_);
    sigaction(SIGTERM, &action, &terminate_before_);
    sigaction(SIGHUP, nullptr, &hangup_before_);
    // nohup(1) has it ignored, and so it stays.
    if (hangup_before_.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
    // A reader that went away and a file that may not grow are results of write().
    ::signal(SIGPIPE, SIG_IGN);
    ::signal(SIGXFSZ, SIG_IGN);
    thread_ = std::jthread{[this] { wait(); }};
}

Signals::~Signals() {
    sigaction(SIGINT, &interrupt_before_, nullptr);
    sigaction(SIGTERM, &terminate_before_, nullptr);
    sigaction(SIGHUP, &hangup_before_, nullptr);
    wake_fd = -1;
    close(write_end_);
    thread_.join();
    close(read_end_);
    pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
}

bool Signals::stopping() const {
    return first_signal.came();
}

void Signals::on_stop(std::function<void()> stop) {
    const std::lock_guard lock{mutex_};
    stop_ = std::move(stop);
    if (stopping() && stop_) stop_();
}

void Signals::wait() {
    const sigset_t set = watched();
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
    for (char byte = 0;;) {
        const ssize_t count = read(read_end_, &byte, 1);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return;
        const std::lock_guard lock{mutex_};
        if (stop_) stop_();
    }
}

}  // namespace eventide::app
