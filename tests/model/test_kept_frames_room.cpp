// Which of the frames kept for copying makes room for another.
#include "src/model/render/kept_frames.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

/// Of frames as large as these two are kept.
TEST(KeptFrames, TheOneUsedLongestAgoMakesRoom) {
    const FrameKind kind{.geometry = {.part_width = 1200, .part_height = 800}, .read = {}};
    KeptFrames kept;
    kept.make_room(kind.geometry, 3);
    const auto is_kept = [&](double fraction) {
        KeptFrame& frame = kept.choose(kind, fraction, 0);
        const bool was = frame.tiles[0].k != 0 && frame.tiles[0].fraction == fraction;
        frame.tiles[0] = {1, fraction};
        return was;
    };
    EXPECT_FALSE(is_kept(.1));
    EXPECT_FALSE(is_kept(.2));
    EXPECT_TRUE(is_kept(.1));
    EXPECT_FALSE(is_kept(.3)) << "instead of the one at .2";
    EXPECT_TRUE(is_kept(.1));
    EXPECT_FALSE(is_kept(.2));
    EXPECT_FALSE(is_kept(.3));
    EXPECT_FALSE(is_kept(.1));
}

TEST(KeptFrames, OneThatMakesRoomForAnotherKindTellsNothingOfIt) {
    FrameKind kind{.geometry = {.part_width = 2000, .part_height = 1200},
                   .read = {}};  // one is kept
    KeptFrames kept;
    kept.make_room(kind.geometry, 3);
    kept.choose(kind, .5, 0).tiles[0] = {7, .5};
    EXPECT_EQ(kept.choose(kind, .25, 0).tiles[0].k, 7) << "what is still true saves rendering";
    kind.rule = kind.rule == SigmaRule::mixture ? SigmaRule::log_blend : SigmaRule::mixture;
    EXPECT_EQ(kept.choose(kind, .5, 0).tiles[0].k, 0);
}

}  // namespace
}  // namespace eventide
