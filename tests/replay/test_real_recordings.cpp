// Real recordings give the numbers that are known of them.
#include "replay/formats.h"
#include "replay/summary.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>

namespace eventide {
namespace {

struct Known {
    const char* path;
    const char* format;
    int width, height;
    std::uint64_t events, on;
    std::int64_t first_us, last_us;
    std::uint64_t frames, imu, triggers;

    friend std::ostream& operator<<(std::ostream& out, const Known& known) {
        return out << known.path;
    }
};

class RealRecordings : public testing::TestWithParam<Known> {};

TEST_P(RealRecordings, GiveTheKnownNumbers) {
    const Known& known = GetParam();
    const auto path =
        std::filesystem::path(EVENTIDE_SOURCE_DIR) / ".." / "shared" / "data" / known.path;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << known.path << " at hand";
    const auto recording = open_recording(path.string());
    const Summary sum = summarize(*recording);
    EXPECT_EQ(sum.format, known.format);
    EXPECT_EQ(sum.width, known.width);
    EXPECT_EQ(sum.height, known.height);
    EXPECT_EQ(sum.events, known.events);
    EXPECT_EQ(sum.on, known.on);
    ASSERT_TRUE(sum.first && sum.last);
    EXPECT_EQ(to_us(*sum.first), known.first_us);
    EXPECT_EQ(to_us(*sum.last), known.last_us);
    EXPECT_EQ(sum.frames, known.frames);
    EXPECT_EQ(sum.imu, known.imu);
    EXPECT_EQ(sum.triggers, known.triggers);
    EXPECT_EQ(sum.damaged.total(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Text, RealRecordings,
                         testing::Values(Known{"recordings/camerashake_b", "text", 240, 180,
                                               1107449, 538457, 0, 598279, 13, 0, 0},
                                         Known{"recordings/slider_depth_head", "text", 240, 180,
                                               50000, 21147, 3811, 174156, 5, 0, 0},
                                         Known{"recordings/slider_depth_70_71", "text", 240, 180,
                                               16418, 7353, 2713584, 2752335, 2, 0, 0},
                                         Known{"recordings/davis346_desk", "text", 346, 260, 6676,
                                               3563, 3903, 173844, 4, 0, 0},
                                         Known{"recordings/davis346_robotarm", "text", 346, 260,
                                               117667, 72363, 0, 129999, 3, 0, 0}));

INSTANTIATE_TEST_SUITE_P(Aedat2, RealRecordings,
                         testing::Values(Known{"formats/davis240_imu_rotdisk.aedat2", "aedat2", 240,
                                               180, 374296, 163098, 341678, 3508437, 0, 51688 / 7,
                                               0},
                                         Known{"formats/dvs128_short.aedat2", "aedat2", 128, 128,
                                               130114, 74991, 113476330, 119657829, 0, 0, 0}));

INSTANTIATE_TEST_SUITE_P(
    Aedat4, RealRecordings,
    testing::Values(Known{"formats/davis346_robotarm.aedat4", "aedat4", 346, 260, 117667, 72363,
                          1633953690975950, 1633953691105949, 3, 130, 15},
                    Known{"formats/davis346_desk.aedat4", "aedat4", 346, 260, 6676, 3563,
                          1589163147368868, 1589163147538809, 4, 160, 17}));

INSTANTIATE_TEST_SUITE_P(Prophesee, RealRecordings,
                         testing::Values(Known{"formats/evt2_640x480.raw", "evt2", 640, 480, 539481,
                                               367855, 1317888, 1367888, 0, 0, 0},
                                         Known{"formats/ncars_4407_td.dat", "dat", 128, 128, 4407,
                                               1671, 0, 99937, 0, 0, 0}));

}  // namespace
}  // namespace eventide
