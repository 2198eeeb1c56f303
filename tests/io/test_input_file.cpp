// Files that are read whole end, or are refused.
#include "src/io/input_file.h"
#include "tests/support/error_of.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <string>

namespace eventide {
namespace {

class InputFile : public testing::Test {
protected:
    test::TempFolder temp_;
};

TEST_F(InputFile, TextIsReadUpToALimit) {
    const std::string most(1 << 20, 'a');
    test::write_text(temp_ / "most", most);
    test::write_text(temp_ / "more", most + "b");
    EXPECT_EQ(read_text_file(temp_ / "most", ErrorKind::input, most.size()), most);
    EXPECT_EQ(read_text_file(temp_ / "more"), most + "b");
    EXPECT_EQ(test::error_of([&] { read_text_file(temp_ / "more", ErrorKind::usage, most.size()); },
                             ErrorKind::usage),
              std::string(temp_ / "more") + ": expected at most 1 MiB of text, found more");
}

TEST_F(InputFile, TextThatNeverEndsIsRefused) {
    for (const char* endless : {"/dev/zero", "/dev/full"})
        EXPECT_EQ(test::error_of([&] { read_text_file(endless); }, ErrorKind::input),
                  std::string{endless} + ": expected at most 4 MiB of text, found more");
}

TEST_F(InputFile, AnEmptyNameIsSaid) {
    EXPECT_EQ(test::error_of([] { read_text_file("", ErrorKind::usage); }, ErrorKind::usage),
              "expected the name of a file, found ''");
}

TEST_F(InputFile, NumbersAreReadOfFilesAlone) {
    test::write_text(temp_ / "four", "1234");
    EXPECT_EQ(read_bytes_of_file(temp_ / "four").size(), 4U);
    EXPECT_EQ(test::error_of([&] { read_bytes_of_file("/dev/zero"); }, ErrorKind::input),
              "/dev/zero: expected a file, found a pipe or a device");
    EXPECT_NE(test::error_of([&] { read_bytes_of_file(temp_ / "none"); }, ErrorKind::input)
                  .find("cannot be read"),
              std::string::npos);
}

}  // namespace
}  // namespace eventide
