// One thread that waits for signals; nothing happens in signal handlers.
#include "src/app/signals.h"

#include <signal.h>
#include <unistd.h>

#include <string_view>

namespace eventide::app {

namespace {

sigset_t watched() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGUSR2);  // our own destructor
    return set;
}

void say(std::string_view words) {
    // Not through the logger: it may be what hangs.
    [[maybe_unused]] const auto written = write(STDERR_FILENO, words.data(), words.size());
}

}  // namespace

Signals::Signals() {
    const sigset_t set = watched();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    ::signal(SIGPIPE, SIG_IGN);
    thread_ = std::jthread{[this] { wait(); }};
}

Signals::~Signals() {
    done_ = true;
    pthread_kill(thread_.native_handle(), SIGUSR2);
}

void Signals::on_stop(std::function<void()> stop) {
    const std::lock_guard lock{mutex_};
    stop_ = std::move(stop);
    if (stopping_ && stop_) stop_();
}

void Signals::wait() {
    const sigset_t set = watched();
    for (int number = 0; sigwait(&set, &number) == 0 && !done_;) {
        if (number == SIGUSR2) continue;
        if (stopping_.exchange(true)) {
            say("\neventide: stopped at once; files may be incomplete\n");
            _exit(128 + number);
        }
        const std::lock_guard lock{mutex_};
        if (stop_) stop_();
    }
}

}  // namespace eventide::app
