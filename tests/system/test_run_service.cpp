// What eventide run tells a service manager.
#include "tests/support/manager_socket.h"
#include "tests/system/program_test.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

class RunService : public ProgramTest {};

TEST_F(RunService, ASourceThatHasNotBegunIsAliveForAServiceManager) {
    ManagerSocket socket{temp_ / "notify"};
    Process process = start(
        {"run", "udp://127.0.0.1:0?size=32x24", "--out", "null"},
        {.environment = {{"NOTIFY_SOCKET", temp_ / "notify"}, {"WATCHDOG_USEC", "30000000"}}});
    while (process.running() && socket.next() != "WATCHDOG=1") continue;
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait().exit_code, 0);
}

TEST_F(RunService, WhatWaitsForTheReaderOfARecordingIsAliveForAServiceManager) {
    const std::string pipe = temp_ / "all.aedat4";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    ManagerSocket socket{temp_ / "notify"};
    Process process = start(
        {"run", "sim:demo?size=32x24", "--out", "null", "--record", pipe},
        {.environment = {{"NOTIFY_SOCKET", temp_ / "notify"}, {"WATCHDOG_USEC", "30000000"}}});
    const int reader = ::open(pipe.c_str(), O_RDONLY);
    const int size = ::fcntl(reader, F_GETPIPE_SZ);
    for (int waiting = 0; process.running() && waiting + PIPE_BUF < size;)
        ::ioctl(reader, FIONREAD, &waiting);
    // What has come until then is worked on for a while; a status comes once a second.
    int statuses = 0, alive = 0;
    while (process.running() && statuses < 4) {
        const std::string message = socket.next();
        statuses += message.starts_with("STATUS=") ? 1 : 0;
        alive += statuses == 3 && message == "WATCHDOG=1" ? 1 : 0;
    }
    EXPECT_GT(alive, 0);
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait().exit_code, 0);
    ::close(reader);
}

TEST_F(RunService, TellsAServiceManagerOfItsBeginningItsLifeAndItsEnd) {
    ManagerSocket socket{temp_ / "notify"};
    const Result result =
        run({EVENTIDE_PROGRAM, "run", "sim:demo?size=32x24&seconds=1.2", "--out", "null"},
            {.environment = {{"NOTIFY_SOCKET", temp_ / "notify"}, {"WATCHDOG_USEC", "30000000"}},
             .folder = temp_.path().string()});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    std::vector<std::string> messages;
    for (std::string next = socket.next(); next != "nothing"; next = socket.next())
        messages.push_back(next);
    ASSERT_GE(messages.size(), 3U);
    EXPECT_EQ(messages.front(), "READY=1");
    EXPECT_EQ(messages.back(), "STOPPING=1");
    EXPECT_GE(std::ranges::count(messages, "WATCHDOG=1"), 1);
}

}  // namespace
}  // namespace eventide::test
