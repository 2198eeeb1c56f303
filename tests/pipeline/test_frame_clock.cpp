// Frames are asked for at t0 + k / fps, for days, whatever the event windows are.
#include "pipeline/frame_clock.h"
#include "src/core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace eventide {
namespace {

TEST(FrameRate, IsReadAsAFraction) {
    EXPECT_EQ(parse_frame_rate("120"), (FrameRate{120, 1}));
    EXPECT_EQ(parse_frame_rate("29.97"), (FrameRate{2997, 100}));
    EXPECT_EQ(parse_frame_rate("30000/1001"), (FrameRate{30000, 1001}));
    EXPECT_EQ(parse_frame_rate("0.5"), (FrameRate{1, 2}));
    EXPECT_EQ(parse_frame_rate(".25"), (FrameRate{1, 4}));
    EXPECT_EQ(parse_frame_rate("1000000"), (FrameRate{1'000'000, 1}));
}

TEST(FrameRate, RefusesByName) {
    for (const std::string text :
         {"", "0", "-1", "1/0", "1000001", "1000000.1", "abc", "30fps", "1e3", "1.", "1/", "/1",
          "0.0", " 30", "9999999999999", "1.12345678"})
        try {
            parse_frame_rate(text);
            ADD_FAILURE() << "took '" << text << "'";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_NE(std::string{error.what()}.find("in digits"), std::string::npos)
                << "100000 and not 1e5";
        }
}

TEST(FrameClock, DoesNotDriftOverDays) {
    constexpr std::int64_t kEpoch = 1'700'000'000'000'000;
    for (const FrameRate rate : {FrameRate{2997, 100}, FrameRate{30000, 1001}, FrameRate{1000, 1},
                                 FrameRate{1, 3}, FrameRate{333'333, 1}}) {
        const FrameClock clock(rate, from_us(kEpoch));
        const auto per_week =
            std::uint64_t(7 * 86'400 * (long double)(rate.frames) / (long double)(rate.seconds));
        for (std::uint64_t k = 0; k < 2 * per_week; k += 1 + per_week / 1000) {
            const long double exact =
                (long double)(k)*1e6L * (long double)(rate.seconds) / (long double)(rate.frames);
            EXPECT_LE(std::abs((long double)(to_us(clock.time_of(k)) - kEpoch) - exact), 0.5001L);
        }
    }
}

TEST(FrameClock, CountsTheFramesUntilATime) {
    for (const FrameRate rate : {FrameRate{2997, 100}, FrameRate{1000, 1}, FrameRate{999'999, 1},
                                 FrameRate{7, 3}, FrameRate{1'000'000, 1}}) {
        const FrameClock clock(rate, from_us(500));
        EXPECT_EQ(clock.count_until(from_us(499)), 0U);
        EXPECT_EQ(clock.count_until(from_us(500)), 1U);
        std::uint64_t count = 1;
        for (std::int64_t t = 501; t < 500 + 2'000'000; ++t) {
            while (clock.time_of(count) <= from_us(t)) ++count;
            ASSERT_EQ(clock.count_until(from_us(t)), count) << t;
        }
    }
}

std::vector<std::pair<std::int64_t, std::uint64_t>> frames_of(FrameSchedule& schedule,
                                                              const std::vector<Window>& windows) {
    std::vector<std::pair<std::int64_t, std::uint64_t>> frames;
    bool first = true;
    for (const Window& window : windows) {
        schedule.open(window);
        while (schedule.due() > 0) {
            const DueFrame due = schedule.next();
            EXPECT_TRUE(due.t > window.begin || (first && due.t == window.begin));
            EXPECT_LE(due.t, window.end);
            frames.emplace_back(to_us(due.t), due.index);
        }
        first = false;
    }
    return frames;
}

std::vector<Window> random_windows(unsigned seed, std::int64_t begin, std::int64_t end) {
    std::mt19937 rng{seed};
    std::vector<Window> windows;
    while (begin < end) {
        const auto next = std::min<std::int64_t>(end, begin + 1 + std::int64_t(rng() % 50'000));
        windows.push_back({from_us(begin), from_us(next)});
        begin = next;
    }
    return windows;
}

TEST(FrameSchedule, GivesTheSameFramesHoweverTheEventWindowsAreCut) {
    for (const FrameRate rate : {FrameRate{2997, 100}, FrameRate{1000, 1}, FrameRate{3, 1}}) {
        FrameSchedule whole(rate);
        const auto expected = frames_of(whole, {{from_us(123), from_us(2'000'123)}});
        EXPECT_EQ(expected.size(), std::size_t(1 + 2 * rate.frames / rate.seconds));
        for (unsigned seed = 0; seed < 20; ++seed) {
            FrameSchedule cut(rate);
            EXPECT_EQ(frames_of(cut, random_windows(seed, 123, 2'000'123)), expected);
        }
    }
}

TEST(FrameSchedule, WithoutARateGivesOneFrameAtTheEndOfEachEventWindow) {
    FrameSchedule schedule({});
    EXPECT_EQ(frames_of(schedule, {{from_us(0), from_us(10)}, {from_us(10), from_us(13)}}),
              (std::vector<std::pair<std::int64_t, std::uint64_t>>{{10, 0}, {13, 1}}));
}

TEST(FrameSchedule, BeginsWhereItIsAsked) {
    const std::vector<Window> windows = random_windows(3, 0, 1'000'000);
    FrameSchedule schedule({100, 1}, from_us(500'005));
    const auto frames = frames_of(schedule, windows);
    ASSERT_EQ(frames.size(), 50U);
    EXPECT_EQ(frames[0], (std::pair<std::int64_t, std::uint64_t>{500'005, 0}));
    EXPECT_EQ(frames[1].first, 510'005);
    FrameSchedule without_rate({}, from_us(500'005));
    for (const auto& frame : frames_of(without_rate, windows)) EXPECT_GE(frame.first, 500'005);
    FrameSchedule at_an_end({}, windows[2].end);
    EXPECT_EQ(frames_of(at_an_end, windows).front().first, to_us(windows[2].end));
}

TEST(FrameSchedule, OfAStreamThatBeginsLaterThanAskedBeginsWithIt) {
    FrameSchedule schedule({100, 1}, from_us(5));
    EXPECT_EQ(
        frames_of(schedule, {{from_us(1'000'000), from_us(1'015'000)}}),
        (std::vector<std::pair<std::int64_t, std::uint64_t>>{{1'000'000, 0}, {1'010'000, 1}}));
}

TEST(FrameSchedule, BeginsAnewWithTheCamerasClockAndGoesOnCounting) {
    FrameSchedule schedule({100, 1});
    EXPECT_EQ(frames_of(schedule, {{from_us(1'000'000), from_us(1'025'000)}}).back(),
              (std::pair<std::int64_t, std::uint64_t>{1'020'000, 2}));
    schedule.restart();
    EXPECT_EQ(frames_of(schedule, {{from_us(7), from_us(15'000)}}),
              (std::vector<std::pair<std::int64_t, std::uint64_t>>{{7, 3}, {10'007, 4}}));
}

TEST(FrameSchedule, ATimeToBeginAtIsOneOfTheFirstClock) {
    FrameSchedule schedule({100, 1}, from_us(9'000'000));
    EXPECT_EQ(frames_of(schedule, {{from_us(8'990'000), from_us(9'005'000)}}).size(), 1U);
    schedule.restart();
    EXPECT_EQ(frames_of(schedule, {{from_us(7), from_us(15'000)}}).size(), 2U);
}

TEST(FrameSchedule, ANewRateGoesOnFromTheLastFrame) {
    FrameSchedule schedule({100, 1});
    using Frames = std::vector<std::pair<std::int64_t, std::uint64_t>>;
    EXPECT_EQ(frames_of(schedule, {{from_us(0), from_us(25'000)}}),
              (Frames{{0, 0}, {10'000, 1}, {20'000, 2}}));
    schedule.change_rate({200, 1});
    EXPECT_EQ(frames_of(schedule, {{from_us(25'000), from_us(40'000)}}),
              (Frames{{25'001, 3}, {30'001, 4}, {35'001, 5}}))
        << "the next would lie before the window, whose first instant it is instead";
    schedule.change_rate({50, 1});
    schedule.change_rate({20, 1});
    EXPECT_EQ(frames_of(schedule,
                        {{from_us(40'000), from_us(60'000)}, {from_us(60'000), from_us(140'000)}}),
              (Frames{{85'001, 6}, {135'001, 7}}));
}

TEST(FrameSchedule, ANewRateOfANewClockBeginsWithThat) {
    FrameSchedule schedule({100, 1});
    using Frames = std::vector<std::pair<std::int64_t, std::uint64_t>>;
    EXPECT_EQ(frames_of(schedule, {{from_us(9'000'000), from_us(9'005'000)}}),
              (Frames{{9'000'000, 0}}));
    schedule.change_rate({200, 1});
    schedule.restart();
    EXPECT_EQ(frames_of(schedule, {{from_us(7), from_us(6'000)}}), (Frames{{7, 1}, {5'007, 2}}));
}

TEST(FrameSchedule, ARateCanBeginWhereThereWasNone) {
    FrameSchedule schedule({});
    using Frames = std::vector<std::pair<std::int64_t, std::uint64_t>>;
    EXPECT_EQ(frames_of(schedule, {{from_us(0), from_us(10'000)}}), (Frames{{10'000, 0}}));
    schedule.change_rate({250, 1});
    EXPECT_EQ(frames_of(schedule, {{from_us(10'000), from_us(20'000)}}),
              (Frames{{14'000, 1}, {18'000, 2}}));
}

TEST(FrameSchedule, ARateThatBeginsWithANewClockKnowsNoFrameOfTheOldOne) {
    FrameSchedule schedule({});
    using Frames = std::vector<std::pair<std::int64_t, std::uint64_t>>;
    EXPECT_EQ(frames_of(schedule, {{from_us(9'000'000), from_us(9'005'000)}}),
              (Frames{{9'005'000, 0}}));
    schedule.restart();
    schedule.change_rate({200, 1});
    EXPECT_EQ(frames_of(schedule, {{from_us(7), from_us(6'000)}}), (Frames{{7, 1}, {5'007, 2}}));
}

TEST(FrameSchedule, ARateThatIsChangedBeforeTheFirstFrameIsTheRate) {
    FrameSchedule schedule({100, 1}, from_us(5000));
    schedule.change_rate({1000, 1});
    EXPECT_EQ(frames_of(schedule, {{from_us(0), from_us(6000)}}).size(), 2U);
}

}  // namespace
}  // namespace eventide
