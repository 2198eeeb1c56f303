// What one damaged bit may cost, in every format.
#include "replay/formats.h"
#include "tests/replay/made_formats.h"

namespace eventide {
namespace {

class OneFlippedBit : public testing::TestWithParam<const char*> {};

// Not AEDAT 4, where a bit of a packed block may change the times of many events in one way, and
// not RAW, where high times rule (docs/formats.md).
INSTANTIATE_TEST_SUITE_P(Formats, OneFlippedBit,
                         testing::Values("text", "aedat1", "aedat2", "aedat3", "dat"),
                         [](const auto& each) { return std::string(each.param); });

TEST_P(OneFlippedBit, CostsAtMostAPacketOrTheEventsOfAMoment) {
    // 10 us between events on average: a packet of 4096, or 100 ms.
    constexpr std::size_t kMaxLost = 11'000;
    const TestFolder folder;
    const auto events = some_events(60'000, 3'000'000);
    const std::string whole = read_text(write_as(folder, GetParam(), events));
    std::mt19937 random(1);
    for (int i = 0; i < 40; ++i) {
        std::string damaged = whole;
        const std::size_t at = 4'000 + random() % (damaged.size() - 4'000);
        const auto bit = random() % 8;
        damaged[at] ^= char(1 << bit);
        const auto recording = open_recording(folder.write("damaged", damaged));
        EXPECT_GE(read_everything(*recording).events.size(), events.size() - kMaxLost)
            << "bit " << bit << " of byte " << at;
    }
}

}  // namespace
}  // namespace eventide
