// The command line of eventide-pack-images.
#include "tests/system/process.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <string>

namespace eventide::test {
namespace {

using testing::HasSubstr;

class PackImages : public testing::Test {
protected:
    PackImages() {
        std::filesystem::create_directory(temp_ / "photographs");
        for (const char* name : {"a.pgm", "b.pgm"})
            write_text(temp_ / "photographs" + "/" + name, "P2 2 2 255 0 10 20 30\n");
    }
    Result pack(const std::string& longest, const std::string& first) const {
        return run({EVENTIDE_PACK_IMAGES, "out.pack", longest, "photographs", first, "0"},
                   {.folder = temp_.path()});
    }
    TempFolder temp_;
};

TEST_F(PackImages, WritesThoseFromTheFirstOn) {
    const Result result = pack("400", "1");
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result.output, "1 image\n");
    EXPECT_TRUE(std::filesystem::exists(temp_ / "out.pack"));
}

/// A pack of none would be refused by whoever reads it, and one of single pixels by nobody.
TEST_F(PackImages, RefusesWhatLeavesNoImages) {
    const Result none = pack("400", "2");
    EXPECT_EQ(none.exit_code, 2);
    EXPECT_THAT(none.error, HasSubstr("photographs: expected FIRST below 2"));
    const Result nothing_of_each = pack("0", "0");
    EXPECT_EQ(nothing_of_each.exit_code, 2);
    EXPECT_THAT(nothing_of_each.error, HasSubstr("expected a whole number from 1 on, found '0'"));
    EXPECT_FALSE(std::filesystem::exists(temp_ / "out.pack"));
}

}  // namespace
}  // namespace eventide::test
