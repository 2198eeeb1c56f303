// Frames are rendered when the latent maps they need are there, and with no other.
#include "src/core/error.h"
#include "tests/pipeline/frame_output_by_hand.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace eventide {
namespace {

using namespace test;

TEST(FrameOutput, RendersEachFrameWithItsLookahead) {
    for (const int lookahead : {0, 1, 2}) {
        FrameOutputByHand e(lookahead);
        for (int k = 0; k < 4; ++k) e.give(10 * k);
        const auto before_end = e.sink.seen.size();
        EXPECT_EQ(before_end, std::size_t(1 + 2 * (4 - lookahead)));
        e.output.finish();
        EXPECT_TRUE(e.renderer.finished);
        EXPECT_EQ(e.times(), (std::vector<std::int64_t>{0, 5, 10, 15, 20, 25, 30, 35, 40}));
        for (std::size_t i = 0; i < before_end; ++i) {
            const std::size_t k = i == 0 ? 1 : (i + 1) / 2;  // the event window, from 1
            EXPECT_EQ(e.pushed[i], k + std::size_t(lookahead)) << i;
        }
        for (const auto& seen : e.sink.seen) {
            EXPECT_LE(seen.t_us, seen.end_us);
            EXPECT_GE(seen.t_us, seen.begin_us);
        }
    }
}

TEST(FrameOutput, GivesNoneOneOrManyFramesPerEventWindow) {
    FrameOutputByHand seldom(0, {40'000, 1});  // each 25 us
    for (int k = 0; k < 6; ++k) seldom.give(10 * k);
    EXPECT_EQ(seldom.times(), (std::vector<std::int64_t>{0, 25, 50}));
    FrameOutputByHand often(0, {1'000'000, 1});
    for (int k = 0; k < 6; ++k) often.give(10 * k);
    EXPECT_EQ(often.sink.seen.size(), 61U);
    FrameOutputByHand without_rate(1, {});
    for (int k = 0; k < 3; ++k) without_rate.give(10 * k);
    without_rate.output.finish();
    EXPECT_EQ(without_rate.times(), (std::vector<std::int64_t>{10, 20, 30}));
}

TEST(FrameOutput, TellsOfAGapBeforeAWindowWithoutFramesWithTheNextFrame) {
    FrameOutputByHand e(0, {40'000, 1});  // each 25 us
    e.give(0);
    e.give_after_gap(10);
    for (int k = 2; k < 6; ++k) e.give(10 * k);
    ASSERT_EQ(e.times(), (std::vector<std::int64_t>{0, 25, 50}));
    EXPECT_FALSE(e.sink.seen[0].gap);
    EXPECT_TRUE(e.sink.seen[1].gap) << "the window before had no frame";
    EXPECT_FALSE(e.sink.seen[2].gap) << "told once";
}

TEST(FrameOutput, TellsOfAGapWithAllFramesOfItsWindow) {
    FrameOutputByHand e(0);  // each 5 us
    e.give(0);
    e.give_after_gap(10);
    e.give(20);
    std::vector<bool> gaps;
    for (const auto& seen : e.sink.seen) gaps.push_back(seen.gap);
    EXPECT_EQ(gaps, (std::vector<bool>{false, false, false, true, true, false, false}));
}

TEST(FrameOutput, FinishesTheOldStreamBeforeANewOne) {
    FrameOutputByHand e(2);
    for (int k = 0; k < 3; ++k) e.give(1000 + 10 * k);
    e.give(3, true);
    EXPECT_EQ(e.times().back(), 1030);
    EXPECT_EQ(e.renderer.pushed(), 1U);
    e.output.finish();
    EXPECT_EQ(e.times().back(), 13);
    for (std::size_t i = 0; i < e.sink.seen.size(); ++i) EXPECT_EQ(e.sink.seen[i].index, i);
}

TEST(FrameOutput, StopsBeforeFramesWithoutEnd) {
    FrameOutputByHand e(0);
    e.give(0);
    e.give_silence(10, 1000);
    const auto before = e.sink.count;
    try {
        e.give_silence(1000, 1'633'953'690'975'950);  // 54 years
        FAIL() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_NE(std::string(error.what()).find("--allow-silence"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("from 1000 to 1633953690975950 us"),
                  std::string::npos);
    }
    EXPECT_EQ(e.sink.count, before);
}

TEST(FrameOutput, CountsSilenceInARowAndOnlyWhereItIsNotAllowed) {
    for (const bool allowed : {false, true}) {
        FrameOutputByHand e(0, {1'000'000, 1}, allowed);
        e.sink.keeps = false;
        e.sink.before_write = nullptr;
        e.give_silence(0, 600'000);
        e.give(600'000);
        e.give_silence(600'010, 1'200'000);
        if (allowed)
            e.give_silence(1'200'000, 1'800'000);
        else
            EXPECT_THROW(e.give_silence(1'200'000, 1'800'000), Error);
        EXPECT_EQ(e.sink.count, allowed ? 1'800'001U : 1'200'001U);
    }
}

TEST(FrameOutput, ALiveSourceMayBeSilentForHours) {
    ToyRenderer renderer;
    ToySink sink;
    sink.keeps = false;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    FrameOutput output(
        renderer, {&sink}, {.rate = {1'000'000, 1}, .live = true, .halvings = 10}, [] { return 0; },
        stop, counters, keeper);
    Encoded encoded;
    encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
    encoded.latent.window = {from_us(0), from_us(SilenceGuard::kMost + 1)};
    EXPECT_TRUE(output.take(encoded));
    EXPECT_GT(sink.count, 0U);
}

/// Its third frame has a NaN, in its intensity or its sigma.
class BreakingRenderer final : public RenderStage {
public:
    explicit BreakingRenderer(bool in_sigma) : in_sigma_(in_sigma) {}
    Frame make_output() const override { return good_.make_output(); }
    void take(LatentMap& latent) noexcept override { good_.take(latent); }
    void finish() noexcept override { good_.finish(); }
    void reset() noexcept override { good_.reset(); }
    void render(SensorTime t, const Window& window, Frame& frame) noexcept override {
        good_.render(t, window, frame);
        if (in_sigma_ && frame.sigma.empty()) frame.sigma = frame.intensity;
        if (++rendered_ == 3)
            (in_sigma_ ? frame.sigma : frame.intensity)(1, 2) =
                std::numeric_limits<float>::quiet_NaN();
    }

private:
    bool in_sigma_;
    ToyRenderer good_;
    int rendered_ = 0;
};

TEST(FrameOutput, WritesNoFrameThatIsNotFinite) {
    for (const bool in_sigma : {false, true}) {
        BreakingRenderer renderer{in_sigma};
        ToySink sink;
        StopRequest stop;
        Counters counters;
        LatencyKeeper keeper{{}};
        FrameOutput output(
            renderer, {&sink}, {{200'000, 1}, {}, 0, false, 1}, [] { return 0; }, stop, counters,
            keeper);
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(0), from_us(100)};
        try {
            output.take(encoded);
            FAIL() << "nothing was thrown";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            EXPECT_NE(std::string(error.what()).find("frame 2, at 10 us"), std::string::npos);
        }
        EXPECT_EQ(sink.count, 2U);
        EXPECT_EQ(counters.snapshot().broken_frames, 1U);
    }
}

TEST(FrameOutput, RefusesAnImpossibleLookahead) {
    for (const int lookahead : {-1, 3}) EXPECT_THROW(FrameOutputByHand{lookahead}, Error);
}

/// How many frames are written of a live window that came so long ago.
std::uint64_t frames_of_live(LatencyKeeper& keeper, std::chrono::hours ago) {
    ToyRenderer renderer;
    ToySink sink;
    StopRequest stop;
    Counters counters;
    FrameOutput output(
        renderer, {&sink}, {.rate = {200'000, 1}, .live = true}, [] { return 0; }, stop, counters,
        keeper);
    Encoded encoded;
    encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
    encoded.latent.window = {from_us(0), from_us(20)};
    encoded.latent.arrived = std::chrono::steady_clock::now() - ago;
    output.take(encoded);
    return sink.count;
}

TEST(FrameOutput, RendersEverySecondFrameWhereTheEncoderIsBehind) {
    for (const bool behind : {false, true}) {
        LatencyKeeper keeper{std::chrono::hours{1}};
        keeper.window_took(std::chrono::hours{1});
        keeper.adapt(behind ? 1 : 0);
        EXPECT_EQ(frames_of_live(keeper, {}), behind ? 3U : 5U) << "of 0, 5, 10, 15 and 20 us";
    }
}

TEST(FrameOutput, RendersTheNewestAloneOfAWindowThatIsTooOld) {
    for (const bool old : {false, true}) {
        LatencyKeeper keeper{std::chrono::minutes{30}};
        keeper.frame_took(std::chrono::nanoseconds{1});
        EXPECT_EQ(frames_of_live(keeper, std::chrono::hours{old ? 1 : 0}), old ? 1U : 5U);
    }
}

TEST(FrameOutput, LearnsWhatAFrameTakesAndRendersNoneThatWouldBeLateButTheNewest) {
    ToyRenderer renderer;
    ToySink sink;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{std::chrono::nanoseconds{1}};
    FrameOutput output(
        renderer, {&sink}, {.rate = {200'000, 1}, .live = true}, [] { return 0; }, stop, counters,
        keeper);
    for (const std::int64_t begin_us : {0, 100}) {
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(begin_us), from_us(begin_us + 100)};
        output.take(encoded);
    }
    EXPECT_EQ(sink.count, 21U + 1U) << "as yet nothing was known of the first window's";
    EXPECT_EQ(sink.seen.back().t_us, 200);
}

}  // namespace
}  // namespace eventide
