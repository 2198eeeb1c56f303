// Signals on threads that nobody of ours made.
#include "apps/cli/commands/command_files.h"
#include "apps/cli/signals.h"
#include "src/core/error.h"
#include "src/core/second_signal.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

namespace eventide::app {
namespace {

/// A thread made before Signals, as libraries make them while they are loaded: it blocks no
/// signals. It waits in a read, where the thread sanitizer too lets signals through.
class ForeignThread {
public:
    ForeignThread() {
        EXPECT_EQ(pipe(ends_), 0);
        thread_ = std::jthread{[from = ends_[0]] {
            char byte = 0;
            while (read(from, &byte, 1) < 0) {
            }
        }};
    }
    ~ForeignThread() {
        close(ends_[1]);
        thread_.join();
        close(ends_[0]);
    }
    ForeignThread(const ForeignThread&) = delete;
    ForeignThread& operator=(const ForeignThread&) = delete;
    void interrupt() { pthread_kill(thread_.native_handle(), SIGINT); }

private:
    int ends_[2] = {};
    std::jthread thread_;
};

TEST(SignalsOnAnyThread, TheFirstStopsTheWork) {
    ForeignThread foreign;
    Signals signals;
    std::promise<void> stopped;
    const Stopper stopper{signals, [&] { stopped.set_value(); }};
    EXPECT_FALSE(signals.stopping());
    foreign.interrupt();
    stopped.get_future().wait();
    EXPECT_TRUE(signals.stopping());
}

TEST(SignalsOnAnyThread, WhatCameBeforeThereWasWorkStopsItAtOnce) {
    ForeignThread foreign;
    Signals signals;
    foreign.interrupt();
    while (!signals.stopping()) std::this_thread::yield();
    // Twice where the signals' thread comes to it meanwhile.
    std::atomic<int> calls = 0;
    const Stopper stopper{signals, [&] { ++calls; }};
    EXPECT_GE(calls, 1);
}

TEST(SignalsOnAnyThread, EndTheWaitForWhoeverIsToReadAResult) {
    const test::TempFolder temp;
    const std::string pipe = temp / "result.json";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    ForeignThread foreign;
    const Signals signals;
    foreign.interrupt();
    try {
        write_result(pipe, "{}", false, signals);
        FAIL() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::failed);
        EXPECT_EQ(error.what(), pipe + ": stopped by a signal, and nobody read it");
    }
}

void interrupt_twice_while_the_stop_hangs() {
    ForeignThread foreign;
    Signals signals;
    std::promise<void> hanging, never;
    const Stopper stopper{signals, [&] {
                              hanging.set_value();
                              never.get_future().wait();
                          }};
    foreign.interrupt();
    hanging.get_future().wait();
    for (;;) foreign.interrupt();  // until one comes long enough after the first
}

TEST(SignalsOnAnyThreadDeathTest, TheSecondQuitsEvenIfTheStopHangs) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    EXPECT_EXIT(interrupt_twice_while_the_stop_hangs(), testing::ExitedWithCode(128 + SIGINT),
                "stopped at once");
}

TEST(SecondSignal, ComesSomeTimeAfterTheFirst) {
    using std::chrono::nanoseconds;
    for (const int number : {SIGINT, SIGTERM}) {
        // timeout(1) sends two, one right behind the other, for one wish.
        EXPECT_TRUE(repeats_the_first(number, nanoseconds{0}));
        EXPECT_TRUE(repeats_the_first(number, kOneWish - nanoseconds{1}));
        EXPECT_FALSE(repeats_the_first(number, kOneWish));
    }
    EXPECT_TRUE(repeats_the_first(SIGHUP, std::chrono::hours{1})) << "a terminal closes once";
}

TEST(FirstSignal, WhatComesAtOnceAfterItRepeatsIt) {
    FirstSignal signal;
    EXPECT_FALSE(signal.came());
    EXPECT_EQ(signal.take(SIGTERM), StopWish::first);
    EXPECT_TRUE(signal.came());
    EXPECT_EQ(signal.take(SIGHUP), StopWish::repeated);
    signal.forget();
    EXPECT_FALSE(signal.came());
    EXPECT_EQ(signal.take(SIGHUP), StopWish::first);
}

TEST(SignalsOnAnyThread, AfterwardsAllIsAsBefore) {
    using Action = struct sigaction;
    Action before{}, after{};
    sigset_t mask_before, mask_after;
    sigaction(SIGTERM, nullptr, &before);
    pthread_sigmask(SIG_BLOCK, nullptr, &mask_before);
    { const Signals signals; }
    sigaction(SIGTERM, nullptr, &after);
    pthread_sigmask(SIG_BLOCK, nullptr, &mask_after);
    EXPECT_EQ(after.sa_handler, before.sa_handler);
    EXPECT_EQ(sigismember(&mask_after, SIGTERM), sigismember(&mask_before, SIGTERM));
}

}  // namespace
}  // namespace eventide::app
