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
    const HeldPipes held{{first, second}, {}};
    for (const std::string& path : {first, second}) {
        const int file = ::open(path.c_str(), O_WRONLY | O_NONBLOCK);
        ASSERT_GE(file, 0) << path << ": its reader is there";
        EXPECT_EQ(::write(file, "x", 1), 1);
        ::close(file);
    }
}

TEST_F(HeldPipesTest, AreGivenUpWhereSomebodySaysSo) {
    int asked = 0;
    const HeldPipes held{{pipe("pipe")}, [&] { return ++asked == 2; }};
    EXPECT_EQ(asked, 2);
}

TEST_F(HeldPipesTest, WhatCannotBeOpenedIsNotWaitedFor) {
    const HeldPipes held{{temp_ / "nothing"}, {}};
}

}  // namespace
}  // namespace eventide
