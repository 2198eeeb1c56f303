// What makes no sense is counted or refused with words, and what follows is as if it had not been.
#include "tests/library/library_test.h"

#include <limits>

namespace eventide::test {
namespace {

class HostileEvents : public LibraryTest {};

constexpr auto kMax = std::numeric_limits<std::int64_t>::max();

TEST_F(HostileEvents, AreLeftOutAndCounted) {
    const std::vector<Event> good = events_of(recording());
    std::vector<Event> events;
    for (std::size_t i = 0; i < good.size(); ++i) {
        events.push_back(good[i]);
        if (i % 100 == 50) {
            events.push_back({good[i].t - SensorDuration{5000}, 1, 1, Polarity::on});
            events.push_back({good[i].t, 64, 0, Polarity::on});
            events.push_back(
                {good[i].t, 0, std::uint16_t(i % 200 == 50 ? 48 : 65535), Polarity::on});
            events.push_back({from_us(kMax), 1, 1, Polarity::on});
            events.push_back({from_us(std::numeric_limits<std::int64_t>::min()), 1, 1});
        }
    }
    Reconstructor clean = reconstructor(repeatable("7ms", 1));
    Reconstructor hostile = reconstructor(repeatable("7ms", 1));
    std::string expected, frames;
    clean.push(good);
    clean.finish();
    append_frames(clean, expected);
    hostile.push(std::span<const Event>{});
    hostile.push(events);
    hostile.push(std::span<const Event>{});
    hostile.finish();
    append_frames(hostile, frames);
    EXPECT_TRUE(frames == expected);
    const auto bad = std::uint64_t((good.size() + 49) / 100);
    const ReconstructorCounters counters = hostile.counters();
    EXPECT_EQ(counters.events, events.size());
    EXPECT_EQ(counters.time_backwards, bad);
    EXPECT_EQ(counters.off_sensor, 2 * bad);
    EXPECT_EQ(counters.bad_time, 2 * bad);
    EXPECT_EQ(counters.time_resets, 0U);
}

TEST_F(HostileEvents, OfABatchThatGoesBackBeginANewStream) {
    const std::vector<Event> events = events_of(recording());
    Reconstructor twice = reconstructor(repeatable("7ms", 2)),
                  once = reconstructor(repeatable("7ms", 2));
    Batch batch;
    batch.events = events;
    std::string expected, frames;
    once.push(batch);
    once.finish();
    append_frames(once, expected);
    twice.push(batch);
    twice.push(batch);
    twice.finish();
    append_frames(twice, frames);
    EXPECT_TRUE(frames == expected + expected);
    EXPECT_EQ(twice.counters().time_resets, 1U);
}

TEST_F(HostileEvents, AreCountedWhenTheyArePushed) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    Batch batch;
    batch.events = {{from_us(0), 1, 1}};
    reconstructor.push(batch);
    reconstructor.advance(from_us(100'000));
    EXPECT_TRUE(reconstructor.newest());
    batch.events = {{from_us(50'000), 1, 1}};
    reconstructor.push(batch);
    EXPECT_EQ(reconstructor.counters().late, 1U);
    batch.events = {{from_us(30'000), 1, 1}};
    reconstructor.push(batch);
    EXPECT_EQ(reconstructor.counters().time_resets, 1U);
}

TEST_F(HostileEvents, NoneGiveNoFramesHoweverLongTheClockRan) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    reconstructor.finish(from_us(10'000'000));
    Frame frame;
    EXPECT_FALSE(reconstructor.next(frame));
    EXPECT_EQ(reconstructor.counters().event_windows, 0U);
}

TEST_F(HostileEvents, AfterAResetAreANewStream) {
    const std::vector<Event> events = events_of(recording());
    Reconstructor reconstructor = this->reconstructor(repeatable("auto", 1));
    std::string first, second;
    for (std::string* frames : {&first, &second}) {
        reconstructor.push(events);
        reconstructor.finish();
        append_frames(reconstructor, *frames);
        reconstructor.reset();
    }
    EXPECT_GT(first.size(), 0U);
    EXPECT_TRUE(first == second);
}

TEST_F(HostileEvents, AfterAResetAreANewStreamAlsoForTheNoiseFilter) {
    const std::vector<Event> events = events_of(recording());
    std::vector<Event> later = events;
    for (Event& event : later) event.t += SensorDuration{1'000'000};
    ReconstructorOptions options = repeatable("7ms", 1);
    options.noise_filter = "auto";
    const auto frames_of = [&](Reconstructor& reconstructor) {
        reconstructor.push(later);
        reconstructor.finish();
        std::string frames;
        append_frames(reconstructor, frames);
        return frames;
    };
    Reconstructor fresh = reconstructor(options);
    const std::vector<std::byte> nothing = fresh.state();
    const std::string expected = frames_of(fresh);
    ASSERT_GT(fresh.counters().filtered, 0U);
    for (const bool restores : {false, true}) {
        Reconstructor used = reconstructor(options);
        used.push(events);
        used.newest();
        const std::uint64_t filtered = used.counters().filtered;
        if (restores)
            used.restore(nothing);
        else
            used.reset();
        EXPECT_TRUE(frames_of(used) == expected) << (restores ? "restore()" : "reset()");
        EXPECT_EQ(used.counters().filtered - filtered, fresh.counters().filtered);
    }
}

TEST_F(HostileEvents, FromTheEndsOfTimeGiveNoFramesWithoutEnd) {
    Reconstructor reconstructor = this->reconstructor(repeatable("50ms", 0));
    const std::vector<Event> events{{from_us(-Reconstructor::kFarthestTime), 1, 1},
                                    {from_us(Reconstructor::kFarthestTime), 1, 1}};
    reconstructor.push(events);
    reconstructor.finish();
    Frame frame;
    const std::string words = error_of(
        [&] {
            while (reconstructor.next(frame)) {
            }
        },
        ErrorKind::input);
    EXPECT_NE(words.find("no events from"), std::string::npos) << words;
    EXPECT_NE(words.find("allow_silence"), std::string::npos) << words;
    while (reconstructor.next(frame)) {
    }
    EXPECT_LT(reconstructor.counters().frames, 1000U) << "the silence was skipped";
}

TEST_F(HostileEvents, AndTimesAreRefusedInWords) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    Frame frame;
    EXPECT_EQ(reconstructor.newest(), std::nullopt);
    EXPECT_FALSE(reconstructor.next(frame));
    EXPECT_NE(error_of([&] { reconstructor.render(from_us(5), frame); }).find("not pushed yet"),
              std::string::npos);
    EXPECT_NE(error_of([&] { reconstructor.advance(from_us(kMax)); }).find("2^60"),
              std::string::npos);
    reconstructor.push(events_of(recording()));
    const auto newest = reconstructor.newest();
    ASSERT_TRUE(newest);
    EXPECT_NE(error_of([&] { reconstructor.render(from_us(-5), frame); }).find("remembers"),
              std::string::npos);
    EXPECT_NE(error_of([&] { reconstructor.render(from_us(kMax), frame); }).find("not pushed"),
              std::string::npos);
    reconstructor.finish();
    EXPECT_NE(error_of([&] { reconstructor.push(std::span<const Event>{}); }).find("reset()"),
              std::string::npos);
    EXPECT_NE(error_of([&] { reconstructor.advance(from_us(0)); }).find("finish()"),
              std::string::npos);
    reconstructor.finish();
}

TEST_F(HostileEvents, AndSizesAreRefusedInWords) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    reconstructor.push(events_of(recording()));
    const SensorTime t = reconstructor.newest().value();
    Frame before, after;
    reconstructor.render(t, before);
    const FrameSize impossible[]{{-1, 48},
                                 {64, 100'000},
                                 {64, 48, {-1, 0, 5, 5}},
                                 {64, 48, {60, 0, 5, 5}},
                                 {64, 48, {64, 0}},
                                 {64, 48, {0, 0, -3, 5}},
                                 {64, 48, {std::numeric_limits<int>::max(), 0, 5, 5}},
                                 {64, 48, {0, std::numeric_limits<int>::min(), 5, 5}}};
    for (const FrameSize& size : impossible)
        EXPECT_NE(error_of([&] { reconstructor.render(t, size, after); }).find("expected"),
                  std::string::npos);
    // In words of the library: an option of the program is no argument here.
    const auto words = error_of([&] { reconstructor.render(t, {64, 48, {60, 0, 5, 5}}, after); });
    EXPECT_EQ(words, "region: expected a part of the 64x48 frame, found 5x5 from 60,0");
    error_of([&] {
        reconstructor.render(t, {64, 48, {std::numeric_limits<int>::min(), 0, 0, 5}}, after);
    });
    reconstructor.render(t, after);
    EXPECT_EQ(after.intensity, before.intensity) << "what was refused changed nothing";
}

TEST_F(HostileEvents, AndOptionsAreRefusedInWords) {
    const auto words = [](auto change, ErrorKind kind = ErrorKind::usage) {
        ReconstructorOptions options;
        change(options);
        return error_of([&] { Reconstructor{model(), 64, 48, options}; }, kind);
    };
    EXPECT_NE(words([](auto& o) { o.window = "5 bananas"; }).find("5 bananas"), std::string::npos);
    EXPECT_NE(words([](auto& o) { o.lookahead = 3; }).find("found 3"), std::string::npos);
    EXPECT_NE(words([](auto& o) { o.lookahead = -1; }).find("found -1"), std::string::npos);
    EXPECT_NE(words([](auto& o) { o.fps = "-3"; }).find("'-3'"), std::string::npos);
    EXPECT_NE(words([](auto& o) { o.threads = -1; }).find("found -1"), std::string::npos);
    EXPECT_NE(words([](auto& o) { o.hot_pixels = "/no/such"; }).find("/no/such"),
              std::string::npos);
    EXPECT_NE(error_of([] { Reconstructor{model(), 0, 48}; }).find("found 0"), std::string::npos);
    EXPECT_NE(error_of([] {
                  Reconstructor{model(), 64, 9999};
              }).find("found 9999"),
              std::string::npos);
    EXPECT_NE(error_of(
                  [] {
                      Reconstructor{"nobody", 64, 48};
                  },
                  ErrorKind::input)
                  .find("'nobody'"),
              std::string::npos);
    EXPECT_NE(error_of(
                  [] {
                      Reconstructor{recording(), 64, 48};
                  },
                  ErrorKind::input)
                  .find(recording()),
              std::string::npos);
}

}  // namespace
}  // namespace eventide::test
