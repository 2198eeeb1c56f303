// The newest frame, and what is counted and shared on its way.
#include "pipeline/sinks/http/frame_streams.h"
#include "pipeline/sinks/http/newest_frame.h"
#include "pipeline/sinks/http/slots.h"
#include "tests/pipeline/sinks/http/served.h"

#include <future>

namespace eventide::test {
namespace {

using Clock = NewestFrame::Clock;

Frame frame(int n) {
    return ramp_frame(16, 12, n, odd_time(n));
}

/// A viewer waits; frames are offered until he has one.
std::shared_ptr<const ShownFrame> served(NewestFrame& newest, int first,
                                         const std::shared_ptr<const ShownFrame>& seen) {
    auto waiting =
        std::async(std::launch::async, [&] { return newest.next(seen, Clock::now() + kLong); });
    int n = first;
    while (waiting.wait_for(std::chrono::milliseconds{1}) != std::future_status::ready)
        newest.offer(frame(n++));
    return waiting.get();
}

TEST(NewestFrame, WhoWasAwayGetsANewOneAndNotWhatHeMissed) {
    NewestFrame newest{0.3f};
    const auto first = served(newest, 0, nullptr);
    ASSERT_TRUE(first);
    for (int n = 1000; n < 1100; ++n) newest.offer(frame(n));  // nobody waits
    EXPECT_EQ(newest.copied(), 1U);
    const auto second = served(newest, 2000, first);
    EXPECT_GE(second->frame().index, 2000U);
}

TEST(NewestFrame, EncodingsAreMadeOnceAndShared) {
    const ShownFrame shown{frame(3), 0.3f, std::chrono::milliseconds{2}};
    EXPECT_EQ(&shown.jpeg(Show::intensity), &shown.jpeg(Show::intensity));
    EXPECT_EQ(shown.jpeg(Show::intensity).data(), shown.jpeg(Show::intensity).data());
    EXPECT_NE(shown.jpeg(Show::sigma), shown.jpeg(Show::intensity));
    EXPECT_TRUE(shown.events().empty()) << "no preview was asked for";
}

TEST(NewestFrame, MessageForThePageHoldsItsParts) {
    Frame third = frame(3);
    third.gap_before = true;
    const ShownFrame shown{third, 0.3f, std::chrono::milliseconds{2}};
    const auto& bytes = shown.message();
    const auto number = [&](std::size_t at, int size) {
        std::uint64_t value = 0;
        for (int i = size - 1; i >= 0; --i) value = value << 8 | bytes[at + std::size_t(i)];
        return value;
    };
    EXPECT_EQ(number(0, 4), 0x45545645U);
    EXPECT_EQ(number(4, 4), 64U);
    EXPECT_EQ(number(8, 8), 3U);
    EXPECT_EQ(number(16, 8), std::uint64_t(to_us(odd_time(3))));
    EXPECT_EQ(number(24, 8), 103U);
    EXPECT_EQ(number(32, 8), 2000U);
    EXPECT_EQ(number(40, 8), 50'000U);
    EXPECT_EQ(number(48, 4), shown.jpeg(Show::intensity).size());
    EXPECT_EQ(64 + number(48, 4) + number(52, 4) + number(56, 4), bytes.size());
    EXPECT_EQ(number(60, 4), 1U) << "behind a gap";
}

TEST(NewestFrame, OneThatIsHeldComesOnceToEachAndNoLongerThanItIsHeld) {
    NewestFrame newest{0.3f};
    auto waiting =
        std::async(std::launch::async, [&] { return newest.next(nullptr, Clock::now() + kLong); });
    newest.offer_while_held(frame(1), kLong);
    const auto held = waiting.get();
    ASSERT_TRUE(held);
    const auto until_it_is_not_fresh = Clock::now() + 2 * NewestFrame::kFresh;
    auto again =
        std::async(std::launch::async, [&] { return newest.next(held, until_it_is_not_fresh); });
    newest.offer_while_held(frame(1), std::chrono::milliseconds{20});
    EXPECT_FALSE(again.get()) << "he has it";
    EXPECT_EQ(newest.next(nullptr, Clock::now()), held) << "another has not";
    EXPECT_EQ(newest.copied(), 1U);
    newest.offer(frame(2));  // the pause is over, and nobody waits
    EXPECT_FALSE(newest.next(nullptr, Clock::now()));
}

TEST(NewestFrame, CloseWakesWhoWaits) {
    NewestFrame newest{0.3f};
    auto waiting =
        std::async(std::launch::async, [&] { return newest.next(nullptr, Clock::now() + kLong); });
    newest.close();
    EXPECT_EQ(waiting.get(), nullptr);
    EXPECT_FALSE(newest.sleep(Clock::now() + kLong));
}

TEST(Slots, AreGivenBackWithTheLastCopy) {
    Slots slots{2};
    auto first = slots.take(), second = slots.take();
    EXPECT_FALSE(slots.take());
    EXPECT_EQ(slots.taken(), 2);
    auto copy = first;
    first.reset();
    EXPECT_FALSE(slots.take());
    copy.reset();
    EXPECT_TRUE(slots.take());
}

TEST(EventRate, IsOfTheTimeSinceItWasLastTold) {
    EventRate rate;
    const auto t = Clock::now();
    EXPECT_EQ(rate.at(t, 1'000'000), 0);
    EXPECT_EQ(rate.at(t + std::chrono::milliseconds{250}, 1'200'000), 0) << "too short a span";
    EXPECT_NEAR(rate.at(t + std::chrono::milliseconds{500}, 1'500'000), 1e6, 1);
    EXPECT_NEAR(rate.at(t + std::chrono::milliseconds{1500}, 1'600'000), 1e5, 1);
}

}  // namespace
}  // namespace eventide::test
