// Frames of times and sizes that are asked for, alone and beside those of the frame clock.
#include "src/model/model_file.h"
#include "tests/library/library_test.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

class AskedFrames : public LibraryTest {};

TEST_F(AskedFrames, AreThoseOfTheFrameClock) {
    const std::vector<Event> events = events_of(recording());
    Reconstructor clocked = reconstructor(repeatable("7ms", 2));
    Reconstructor asked = reconstructor(repeatable("7ms", 2));
    for (Reconstructor* one : {&clocked, &asked}) {
        one->push(events);
        one->finish();
    }
    Frame expected, frame;
    for (std::uint64_t index = 0; clocked.next(expected); ++index) {
        EXPECT_EQ(expected.index, index);
        // The first frame of all stands at the begin of the first window, just outside.
        const SensorTime t = std::max(expected.t, expected.window.begin + SensorDuration{1});
        ASSERT_TRUE(asked.ready(t)) << index;
        asked.render(t, frame);
        EXPECT_EQ(frame.t, t);
        EXPECT_EQ(frame.window, expected.window);
        EXPECT_EQ(frame.intensity, expected.intensity) << index;
        EXPECT_EQ(frame.sigma, expected.sigma) << index;
    }
    EXPECT_EQ(asked.counters().frames, clocked.counters().frames);
}

TEST_F(AskedFrames, ThatWentAheadLeaveThoseOfTheFrameClockRightAndAllThere) {
    const std::vector<Event> events = events_of(recording());
    ReconstructorOptions options = repeatable("7ms", 0);
    options.fps = "500";
    // A network that looks back two windows, so that forgetting one too early shows.
    Model network = load_model(model());
    network.config.live_edge = LiveEdge::fade;
    const std::string fading = temp_ / "fading.safetensors";
    save_model(fading, network);
    Reconstructor alone{fading, 64, 48, options};
    alone.push(events);
    std::vector<Frame> expected;
    for (Frame frame; alone.next(frame);) expected.push_back(frame);
    for (int ahead_ms = 1; ahead_ms < 60; ahead_ms += 7) {
        Reconstructor mixed{fading, 64, 48, options};
        mixed.push(events);
        Frame frame;
        std::size_t given = 0;
        for (; given < 20; ++given) ASSERT_TRUE(mixed.next(frame));
        const SensorTime ahead = frame.t + SensorDuration{1000 * ahead_ms};
        if (mixed.ready(ahead))
            mixed.render(ahead, frame);
        else
            EXPECT_GT(ahead_ms, 8) << "a window at least";
        for (; mixed.next(frame); ++given) {
            const Frame& right = expected.at(frame.index);
            ASSERT_EQ(frame.t, right.t);
            ASSERT_EQ(frame.intensity, right.intensity) << frame.index << ", ahead " << ahead_ms;
            ASSERT_EQ(frame.sigma, right.sigma) << frame.index << ", ahead " << ahead_ms;
        }
        EXPECT_EQ(given, expected.size());
    }
}

/// Frames of a silence that next() passed over are no frames in a row.
TEST_F(AskedFrames, OfASilenceThatWasPassedOverAreNotCounted) {
    ReconstructorOptions options = repeatable("50ms", 0);
    options.fps = "1000000";
    Reconstructor reconstructor = this->reconstructor(options);
    const auto events_from = [](std::int64_t begin_us) {
        std::vector<Event> events;
        for (int i = 0; i < 100; ++i)
            events.push_back(
                {from_us(begin_us + 1000 * i), std::uint16_t(i % 64), 5, Polarity::on});
        return events;
    };
    reconstructor.push(events_from(0));
    reconstructor.advance(from_us(3'000'000));
    reconstructor.newest();
    reconstructor.push(events_from(3'000'000));
    reconstructor.newest();
    Frame frame;
    EXPECT_TRUE(reconstructor.next(frame));
}

TEST_F(AskedFrames, LeaveAllThoseOfTheFrameClock) {
    const std::vector<Event> events = events_of(recording());
    for (const int lookahead : {0, 1, 2}) {
        std::string frames[2];
        for (const bool asks : {false, true}) {
            Reconstructor reconstructor = this->reconstructor(repeatable("7ms", lookahead));
            Frame frame, other;
            for (std::size_t at = 0; at < events.size(); at += 5'000) {
                const auto part = std::span{events}.subspan(at);
                reconstructor.push(part.first(std::min<std::size_t>(part.size(), 5'000)));
                // At first there is nothing that may not be passed over.
                if (asks && at > 0) {
                    if (const auto newest = reconstructor.newest())
                        reconstructor.render(*newest, other);
                    reconstructor.ready(events.back().t);
                }
                while (reconstructor.next(frame)) append_frame(frame, frames[asks]);
            }
        }
        EXPECT_TRUE(frames[0] == frames[1]) << lookahead;
        EXPECT_FALSE(frames[0].empty());
    }
}

/// Those of next(), with frames of the newest time asked for before each batch's. From the batch
/// on in which `first` of them have been given.
std::vector<Frame> frames_beside_newer_ones(const std::string& recording,
                                            Reconstructor& reconstructor, std::size_t first) {
    EventReader reader{recording};
    std::vector<Frame> frames;
    Frame frame, other;
    for (Batch batch; reader.read(batch);) {
        reconstructor.push(batch);
        const bool asks = frames.size() >= first;
        if (const auto newest = asks ? reconstructor.newest() : std::nullopt)
            reconstructor.render(*newest, other);
        while (reconstructor.next(frame)) frames.push_back(frame);
    }
    return frames;
}

TEST_F(AskedFrames, LeaveImagesWhereTheyCorrectThoseOfTheFrameClock) {
    constexpr std::size_t kNever = 1'000'000;
    for (const int lookahead : {0, 1, 2}) {
        const ReconstructorOptions options = repeatable("7ms", lookahead);
        Reconstructor alone = reconstructor(options);
        const auto expected = frames_beside_newer_ones(recording(), alone, kNever);
        ASSERT_GT(alone.counters().used_images, 5U);
        for (const std::size_t first : {0, 1}) {
            Reconstructor mixed = reconstructor(options);
            const auto frames = frames_beside_newer_ones(recording(), mixed, first);
            EXPECT_GT(frames.size(), expected.size() / 2);
            if (first > 0) {
                EXPECT_EQ(frames.size(), expected.size()) << "none is left out";
            }
            for (const Frame& frame : frames) {
                const Frame& right = expected.at(frame.index);
                ASSERT_EQ(frame.t, right.t);
                EXPECT_EQ(frame.intensity, right.intensity) << frame.index << ", " << lookahead;
                EXPECT_EQ(frame.sigma, right.sigma) << frame.index << ", " << lookahead;
            }
        }
    }
}

TEST_F(AskedFrames, ReachAsFarAsEverWhereImagesCameBeforeAReset) {
    const std::vector<Event> events = events_of(recording());
    const auto newest_beside_next = [&](Reconstructor& reconstructor) {
        const auto [begin, rest] =
            std::pair{std::span{events}.first(5'000), std::span{events}.subspan(5'000)};
        reconstructor.push(begin);
        Frame frame;
        while (reconstructor.next(frame)) continue;
        reconstructor.push(rest);
        return reconstructor.newest();
    };
    Reconstructor fresh = reconstructor(repeatable("7ms", 0));
    const auto expected = newest_beside_next(fresh);
    ASSERT_TRUE(expected);
    Reconstructor used = reconstructor(repeatable("7ms", 0));
    EventReader reader{recording()};
    for (Batch batch; reader.read(batch);) used.push(batch);
    Frame frame;
    while (used.next(frame)) continue;
    ASSERT_GT(used.counters().used_images, 5U);
    used.reset();
    EXPECT_EQ(newest_beside_next(used), expected);
}

TEST_F(AskedFrames, ReachToTheEndAgainWhereNextWasUsedBeforeAReset) {
    const std::vector<Event> events = events_of(recording());
    Reconstructor fresh = reconstructor(repeatable("7ms", 0));
    fresh.push(events);
    Reconstructor used = reconstructor(repeatable("7ms", 0));
    used.push(events);
    Frame frame;
    ASSERT_TRUE(used.next(frame));
    EXPECT_LT(used.newest(), fresh.newest()) << "frames of next() stay";
    used.reset();
    used.push(events);
    EXPECT_EQ(used.newest(), fresh.newest());
}

TEST_F(AskedFrames, HaveAnySizeFromOneMemory) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    reconstructor.push(events_of(recording()));
    const auto newest = reconstructor.newest();
    ASSERT_TRUE(newest);
    Frame whole, part;
    reconstructor.render(*newest, {96, 72}, whole);
    reconstructor.render(*newest, {96, 72, {10, 20, 30, 40}}, part);
    ASSERT_EQ(part.intensity.height(), 40);
    ASSERT_EQ(part.intensity.width(), 30);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 30; ++x) {
            EXPECT_EQ(part.intensity(y, x), whole.intensity(y + 20, x + 10));
            EXPECT_EQ(part.sigma(y, x), whole.sigma(y + 20, x + 10));
        }
}

TEST_F(AskedFrames, GoOnInSilenceAsFarAsTheClockIsKnown) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    const Event one{from_us(1'000'000), 5, 5, Polarity::on};
    reconstructor.push({&one, 1});
    EXPECT_EQ(reconstructor.readiness(from_us(1'000'000)), Readiness::later);
    reconstructor.advance(from_us(1'020'000));
    EXPECT_EQ(reconstructor.readiness(from_us(1'000'000)), Readiness::ready);
    EXPECT_EQ(reconstructor.readiness(from_us(1'025'000)), Readiness::later);
    EXPECT_EQ(reconstructor.readiness(from_us(900'000)), Readiness::gone);
    reconstructor.advance(from_us(1'500'000));
    EXPECT_EQ(reconstructor.newest(), from_us(1'479'999 + 20'000));
}

}  // namespace
}  // namespace eventide::test
