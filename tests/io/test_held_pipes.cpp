// Named pipes are opened in whatever order their readers come.
#include "src/io/held_pipes.h"

#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <thread>
#include <vector>

namespace eventide {
namespace {

class HeldPipesTest : public testing::Test {
protected:
    std::string pipe(const char* name) {
        std::string path = temp_ / name;
        EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
        return path;
    }
    /// Nobody has it open for writing.
    static bool is_at_its_end(const std::string& path) {
        const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
        char byte = 0;
        const bool is_end = ::read(file, &byte, 1) == 0;
        ::close(file);
        return is_end;
    }
    test::TempFolder temp_;
};

TEST_F(HeldPipesTest, HaveTheirReadersInWhateverOrderTheyCome) {
    const std::string first = pipe("first"), second = pipe("second");
    // Each opening waits for the other side.
    std::jthread reader{[&] {
        const int of_second = ::open(second.c_str(), O_RDONLY);
        const int of_first = ::open(first.c_str(), O_RDONLY);
        char byte = 0;
        EXPECT_EQ(::read(of_first, &byte, 1), 1);
        EXPECT_EQ(::read(of_second, &byte, 1), 1);
        ::close(of_first);
        ::close(of_second);
    }};
    HeldPipes held{{first, second}};
    held.wait({});
    for (const std::string& path : {first, second}) {
        EXPECT_FALSE(is_at_its_end(path)) << "until somebody else writes to it";
        const int file = ::open(path.c_str(), O_WRONLY | O_NONBLOCK);
        ASSERT_GE(file, 0) << path << ": its reader is there";
        EXPECT_EQ(::write(file, "x", 1), 1);
        ::close(file);
    }
}

TEST_F(HeldPipesTest, AreGivenUpWhereSomebodySaysSo) {
    int asked = 0;
    HeldPipes held{{pipe("pipe")}};
    held.wait([&] { return ++asked == 2; });
    EXPECT_EQ(asked, 2);
}

TEST_F(HeldPipesTest, WhatCannotBeOpenedIsNotWaitedFor) {
    HeldPipes held{{temp_ / "nothing"}};
    held.wait({});
}

TEST_F(HeldPipesTest, OnceLetGoLeaveWhatHasTheirNumbersNow) {
    const std::string path = pipe("pipe");
    const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
    int somebody_elses = -1;
    {
        HeldPipes held{{path}};
        held.look();
        held.let_go();
        somebody_elses = ::dup(reader);  // the lowest number that is free
    }
    EXPECT_EQ(::close(somebody_elses), 0);
    ::close(reader);
}

TEST_F(HeldPipesTest, AreLookedForWhileSomethingElseIsWaitedFor) {
    const std::string early = pipe("early"), late = pipe("late");
    HeldPipes held{{early, late}};
    held.look();
    const int of_early = ::open(early.c_str(), O_RDONLY | O_NONBLOCK);
    char byte = 0;
    EXPECT_EQ(::read(of_early, &byte, 1), 0) << "nobody has it open for writing";
    held.look();
    EXPECT_LT(::read(of_early, &byte, 1), 0) << "nothing yet";
    EXPECT_TRUE(is_at_its_end(late));
    held.let_go();
    EXPECT_EQ(::read(of_early, &byte, 1), 0);
    ::close(of_early);
}

}  // namespace
}  // namespace eventide
