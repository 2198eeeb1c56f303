// What a service manager hears, by the protocol of sd_notify(3).
#include "apps/cli/run/start_watch.h"
#include "apps/cli/service_manager.h"
#include "tests/support/manager_socket.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>

namespace eventide::app {
namespace {

class ServiceManagerTest : public testing::Test {
protected:
    ~ServiceManagerTest() override {
        for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
    }
    test::TempFolder temp_;
};

TEST_F(ServiceManagerTest, HearsEachMessageAndNothingThatATerminalWouldObey) {
    test::ManagerSocket socket{temp_ / "notify"};
    setenv("NOTIFY_SOCKET", (temp_ / "notify").c_str(), 1);
    setenv("WATCHDOG_USEC", "30000000", 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
    ServiceManager manager;
    ASSERT_TRUE(manager.is_there());
    EXPECT_EQ(manager.watchdog(), std::chrono::seconds{30});
    manager.ready();
    manager.alive();
    manager.status("30 frames/s\nREADY=0 \x1b[2J");
    manager.stopping();
    EXPECT_EQ(socket.next(), "READY=1");
    EXPECT_EQ(socket.next(), "WATCHDOG=1");
    const std::string status = socket.next();
    EXPECT_TRUE(status.starts_with("STATUS=30 frames/s")) << status;
    EXPECT_EQ(status.find_first_of("\n\x1b"), std::string::npos) << status;
    EXPECT_EQ(socket.next(), "STOPPING=1");
    EXPECT_EQ(socket.next(), "nothing");
}

TEST_F(ServiceManagerTest, HearsAtAnAbstractNameThatItIsReadyOnce) {
    const std::string name = "@eventide-test-" + std::to_string(getpid());
    test::ManagerSocket socket{name};
    setenv("NOTIFY_SOCKET", name.c_str(), 1);
    ServiceManager manager;
    manager.ready();
    manager.ready();
    EXPECT_EQ(socket.next(), "READY=1");
    EXPECT_EQ(socket.next(), "nothing");
}

TEST_F(ServiceManagerTest, WhereNobodyAskedNothingIsSaid) {
    EXPECT_FALSE(ServiceManager{}.is_there());
    for (const std::string& bad : {std::string{"relative"}, std::string(200, '/')}) {
        setenv("NOTIFY_SOCKET", bad.c_str(), 1);
        ServiceManager manager;
        EXPECT_FALSE(manager.is_there()) << bad;
        manager.ready();  // nowhere
    }
    setenv("NOTIFY_SOCKET", (temp_ / "nobody").c_str(), 1);
    ServiceManager nobody_listens;
    nobody_listens.ready();  // neither waits nor throws
}

TEST_F(ServiceManagerTest, TheWatchdogOfAnotherProcessIsNotOurs) {
    test::ManagerSocket socket{temp_ / "notify"};
    setenv("NOTIFY_SOCKET", (temp_ / "notify").c_str(), 1);
    setenv("WATCHDOG_USEC", "30000000", 1);
    setenv("WATCHDOG_PID", "1", 1);
    EXPECT_FALSE(ServiceManager{}.watchdog());
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
    for (const char* never : {"often", "0"}) {
        setenv("WATCHDOG_USEC", never, 1);
        EXPECT_FALSE(ServiceManager{}.watchdog()) << never;
    }
    unsetenv("WATCHDOG_PID");
    setenv("WATCHDOG_USEC", "500", 1);
    EXPECT_EQ(ServiceManager{}.watchdog(), std::chrono::microseconds{500}) << "of any process";
}

TEST_F(ServiceManagerTest, AStartIsAliveBehindAWaitForItsSourceButNotForEver) {
    test::ManagerSocket socket{temp_ / "notify"};
    setenv("NOTIFY_SOCKET", (temp_ / "notify").c_str(), 1);
    setenv("WATCHDOG_USEC", "30000000", 1);
    ServiceManager manager;
    {
        StartWatch start{manager, "events.fifo"};
        start.source_is_waited_for();  // and then it is there, and the rest is opened
        EXPECT_EQ(socket.next(), "READY=1");
        EXPECT_EQ(socket.next(), "STATUS=waiting for events.fifo");
        const auto until = std::chrono::steady_clock::now() + std::chrono::seconds{60};
        int beats = 0;
        while (beats < 3 && std::chrono::steady_clock::now() < until)
            beats += socket.next() == "WATCHDOG=1" ? 1 : 0;
        EXPECT_EQ(beats, 3);
    }
    while (socket.next() != "nothing") continue;
    StartWatch hangs{manager, "events.fifo", std::chrono::milliseconds{0}};
    hangs.source_is_waited_for();
    hangs.end();
    EXPECT_EQ(socket.next(), "STATUS=waiting for events.fifo");
    EXPECT_EQ(socket.next(), "nothing");
}

TEST_F(ServiceManagerTest, AStartIsNotAliveWhereNobodyWatches) {
    test::ManagerSocket socket{temp_ / "notify"};
    setenv("NOTIFY_SOCKET", (temp_ / "notify").c_str(), 1);
    ServiceManager manager;
    StartWatch start{manager, "events.fifo"};
    start.source_is_waited_for();
    start.end();
    EXPECT_EQ(socket.next(), "READY=1");
    EXPECT_EQ(socket.next(), "STATUS=waiting for events.fifo");
    EXPECT_EQ(socket.next(), "nothing");
}

TEST_F(ServiceManagerTest, TheJournalsStreamIsKnownByDeviceAndInode) {
    const int file = open((temp_ / "stream").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
    struct stat status {};
    ASSERT_EQ(fstat(file, &status), 0);
    const std::string device = std::to_string(status.st_dev), inode = std::to_string(status.st_ino);
    EXPECT_TRUE(is_journal(file, device + ":" + inode));
    for (const std::string& other : {device + ":1", "1:" + inode, device, inode, std::string{":"}})
        EXPECT_FALSE(is_journal(file, other)) << other;
    close(file);
}

}  // namespace
}  // namespace eventide::app
