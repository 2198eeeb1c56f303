// Where the live page listens, and why it cannot.
#include "src/core/error.h"
#include "tests/pipeline/sinks/http/served.h"

#include <gmock/gmock.h>

#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <utility>

namespace eventide::test {
namespace {

using testing::HasSubstr;

TEST(HttpListening, SaysWhichPortItWasGiven) {
    const auto sink = open_page();
    EXPECT_GT(sink->address().port, 0);
}

TEST(HttpListening, SaysThatAPortIsInUse) {
    const auto sink = open_page();
    HttpSettings settings;
    settings.address = sink->address();
    try {
        open_http(std::move(settings));
        FAIL() << "two listen at one port";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::failed);
        EXPECT_THAT(error.what(), HasSubstr(std::to_string(sink->address().port)));
        EXPECT_THAT(error.what(), HasSubstr("Address already in use"));
        EXPECT_THAT(error.what(), HasSubstr("another program has it"));
    }
}

/// In a process without a network, where that is permitted.
TEST(HttpListening, AHostThatCannotBeLookedUpNowMayBeLater) {
    constexpr int kNotPermitted = 77;
    const pid_t child = fork();
    if (child == 0) {
        if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) _exit(kNotPermitted);
        HttpSettings settings;
        settings.address.host = "camera.example";
        try {
            open_http(std::move(settings));
        } catch (const Error& error) {  // of kind usage it would not be tried again
            _exit(error.kind() == ErrorKind::failed ? 0 : 1);
        }
        _exit(2);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status));
    if (WEXITSTATUS(status) == kNotPermitted) GTEST_SKIP() << "no network of its own";
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace eventide::test
