// Rate, lookahead and size change while frames come out.
#include "tests/pipeline/frame_output_by_hand.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace eventide {
namespace {

using namespace test;

TEST(FrameOutput, ChangesItsRateWhileItRuns) {
    FrameOutputByHand e(0);
    e.give(0);
    e.changes.set_rate({100'000, 1});  // a frame each 10 us
    e.give(10);
    e.give(20);
    EXPECT_EQ(e.times(), (std::vector<std::int64_t>{0, 5, 10, 20, 30}));
    for (std::size_t i = 0; i < e.sink.seen.size(); ++i) EXPECT_EQ(e.sink.seen[i].index, i);
}

TEST(FrameOutput, RendersEverySecondFrameWhereThatIsAskedFor) {
    FrameOutputByHand e(0);
    e.give(0);
    e.changes.set_halvings(1);
    e.give(10);
    e.changes.set_halvings(2);
    e.give(20);
    e.changes.set_halvings(0);
    e.give(30);
    EXPECT_EQ(e.times(), (std::vector<std::int64_t>{0, 5, 10, 20, 35, 40}));
    for (const auto& seen : e.sink.seen) EXPECT_EQ(std::int64_t(seen.index) * 5, seen.t_us);
    EXPECT_EQ(e.counters.present.skipped_frames.value(), 3U);
}

TEST(FrameOutput, OfALiveSourceRendersEverySecondFrameWhereThatIsAskedFor) {
    ToyRenderer renderer;
    ToySink sink;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    FrameOutput output(
        renderer, {&sink}, {.rate = {200'000, 1}, .live = true, .halvings = 1}, [] { return 0; },
        stop, counters, keeper);
    Encoded encoded;
    encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
    encoded.latent.window = {from_us(0), from_us(20)};
    output.take(encoded);
    EXPECT_EQ(sink.count, 3U) << "of 0, 5, 10, 15 and 20 us";
}

TEST(FrameOutput, ChangesItsLookaheadWithoutLosingAFrame) {
    FrameOutputByHand e(2);
    for (int k = 0; k < 4; ++k) e.give(10 * k);
    EXPECT_EQ(e.times().back(), 20) << "two event windows are waited for";
    e.changes.set_lookahead(0);
    e.give(40);
    EXPECT_EQ(e.times().back(), 50) << "none is waited for";
    e.changes.set_lookahead(1);
    e.give(50);
    EXPECT_EQ(e.times().back(), 50);
    e.give(60);
    EXPECT_EQ(e.times().back(), 60);
    e.output.finish();
    EXPECT_EQ(e.times().size(), 15U);
    EXPECT_EQ(e.lookaheads, (std::vector<int>{2, 2, 2, 2, 2, 2, 2, 1, 1, 0, 0, 1, 1, 0, 0}));
    for (std::size_t i = 0; i < e.sink.seen.size(); ++i) EXPECT_EQ(e.sink.seen[i].index, i);
}

TEST(FrameOutput, KeepsItsLookaheadWhereOneIsAskedForThatThereIsNot) {
    for (const int impossible : {3, 1000, -1}) {
        FrameOutputByHand e(1);
        e.changes.set_lookahead(impossible);
        for (int k = 0; k < 4; ++k) e.give(10 * k);
        EXPECT_EQ(e.times().back(), 30) << impossible << ": all but the last window's frames";
    }
}

TEST(FrameOutput, KeepsWhatItsRendererCannotChange) {
    FrameOutputByHand e(2);
    e.renderer.changeable = false;
    e.changes.set_lookahead(0);
    e.changes.set_size(640, 480);
    for (int k = 0; k < 3; ++k) e.give(10 * k);
    EXPECT_EQ(e.times().back(), 10);
}

}  // namespace
}  // namespace eventide
