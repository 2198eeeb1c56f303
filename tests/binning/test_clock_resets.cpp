// The slicer where the camera's clock begins anew, with all that a stream says beside its events:
// what is cut hangs neither on when windows are taken nor on what a filter leaves out.
#include "src/binning/push_filtered.h"
#include "tests/binning/event_windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>
#include <span>

namespace eventide {
namespace {

/// Leaves out the events of x 0, and holds the others back for 500 us.
class HoldingFilter {
public:
    void process(std::vector<Event>& events) {
        std::vector<Event> out;
        std::ranges::copy_if(events, std::back_inserter(held_),
                             [](const Event& event) { return event.x != 0; });
        if (!events.empty()) take(events.back().t, out);
        events = out;
    }
    void release(SensorTime now, std::vector<Event>& into) { take(now, into); }
    void flush(std::vector<Event>& into) { into = std::exchange(held_, {}); }
    SensorTime known_until(SensorTime now) const { return now - kHeld; }
    std::size_t held() const { return held_.size(); }

private:
    static constexpr SensorDuration kHeld{500};
    void take(SensorTime now, std::vector<Event>& into) {
        const auto first = std::ranges::find_if(
            held_, [now](const Event& event) { return event.t >= now - kHeld; });
        into.insert(into.end(), held_.begin(), first);
        held_.erase(held_.begin(), first);
    }
    std::vector<Event> held_;
};

/// What a stream says, in its order.
struct Word {
    enum { event, image, loss } what;
    Event event_said{};
    SensorTime t{};
};

std::vector<Word> stream_of_several_clocks(unsigned seed) {
    std::mt19937 rng{seed};
    std::vector<Word> words;
    std::int64_t t = 50'000;
    for (int i = 0; i < 1500; ++i) {
        const auto dice = rng() % 1000;
        // Clocks of which a filter leaves nothing, too, pauses of many windows, and bursts.
        if (dice < 6) t = std::int64_t(rng() % 20'000);
        t += dice < 980 ? std::int64_t(rng() % 40) : std::int64_t(rng() % 60'000);
        if (rng() % 80 == 0) words.push_back({Word::loss, {}, {}});
        words.push_back({Word::event, at(t, rng() % 3 == 0 ? 1 : 0), {}});
        if (rng() % 40 == 0) words.push_back({Word::image, {}, from_us(t)});
    }
    return words;
}

/// So many events at once at most; windows are taken after each, or all in the end.
std::vector<Kept> windows_of(const SlicerSettings& settings, const std::vector<Word>& words,
                             std::size_t at_once, bool are_taken_at_once) {
    Slicer slicer{settings, 240, 180};
    HoldingFilter filter;
    std::vector<Kept> windows;
    std::vector<Event> events, room;
    const auto push = [&] {
        if (!events.empty()) push_filtered(slicer, events, filter);
        events.clear();
        if (are_taken_at_once) take(slicer, windows);
    };
    for (const Word& word : words) {
        if (word.what != Word::event || events.size() == at_once) push();
        if (word.what == Word::event) events.push_back(word.event_said);
        if (word.what == Word::image) slicer.push_reference(word.t);
        if (word.what == Word::loss) slicer.mark_gap();
    }
    push();
    flush_filtered(slicer, filter, room);
    slicer.finish();
    take(slicer, windows);
    return windows;
}

TEST(ClockResets, CutTheSameWindowsWheneverTheyAreTakenAndHoweverTheStreamIsSplit) {
    for (const SlicerSettings& settings :
         {by_duration(1000), by_count(10, 2000), by_reference(2000)})
        for (unsigned seed = 1; seed <= 20; ++seed) {
            const auto words = stream_of_several_clocks(seed);
            const auto one_by_one = windows_of(settings, words, 1, true);
            EXPECT_TRUE(std::ranges::any_of(one_by_one, &Kept::reset));
            EXPECT_TRUE(std::ranges::any_of(one_by_one, &Kept::gap));
            for (const std::size_t at_once : {3U, 50U, 2000U})
                for (const bool are_taken_at_once : {true, false}) {
                    const auto windows = windows_of(settings, words, at_once, are_taken_at_once);
                    const auto differ = std::ranges::mismatch(windows, one_by_one);
                    ASSERT_TRUE(differ.in1 == windows.end() && differ.in2 == one_by_one.end())
                        << "seed " << seed << ", " << at_once << " at once, "
                        << (are_taken_at_once ? "taken at once" : "taken in the end") << ", window "
                        << differ.in1 - windows.begin() << ": expected "
                        << testing::PrintToString(*differ.in2) << ", found "
                        << testing::PrintToString(*differ.in1);
                }
        }
}

TEST(ClockResets, AreSeenWhereAFilterLeavesOutAllAround) {
    Slicer slicer{by_duration(1000), 240, 180};
    HoldingFilter filter;
    // Events, then noise alone, of which the clock goes back, then events again.
    std::vector<Event> events{at(10'000, 1), at(12'000), at(14'000), at(3'000), at(11'000, 1)};
    std::vector<Event> room;
    push_filtered(slicer, events, filter);
    flush_filtered(slicer, filter, room);
    slicer.finish();
    std::vector<Kept> windows;
    take(slicer, windows);
    EXPECT_EQ(slicer.counters().time_resets, 1U);
    EXPECT_EQ(slicer.counters().late, 0U);
    const auto reset = std::ranges::find_if(windows, &Kept::reset);
    ASSERT_NE(reset, windows.end());
    EXPECT_EQ(reset->begin_us, 2'999) << "where the noise began";
    EXPECT_EQ(windows.back().events, std::vector{at(11'000, 1)});
}

TEST(ClockResets, LeaveTheMarkOfALossWhereItWas) {
    Slicer slicer{by_duration(10), 240, 180};
    slicer.push(std::vector{at(1), at(12), at(25)});
    slicer.mark_gap();
    slicer.push(std::vector{at(38)});
    slicer.finish();
    std::vector<Kept> windows;
    take(slicer, windows);
    ASSERT_EQ(windows.size(), 4U);
    for (std::size_t i = 0; i < windows.size(); ++i)
        EXPECT_EQ(windows[i].gap, i == 2) << "window " << i << ": 25 us was known before the loss";
}

TEST(ClockResets, ImagesCutWindowsOfTheirOwnClock) {
    Slicer slicer{by_reference(1000), 240, 180};
    slicer.push(std::vector{at(5'000), at(5'600)});
    slicer.push_reference(from_us(5'500));
    slicer.push(std::vector{at(100), at(300)});
    slicer.push_reference(from_us(200));
    slicer.push(std::vector{at(400)});
    slicer.finish();
    std::vector<Kept> windows;
    take(slicer, windows);
    EXPECT_EQ(edges_of(windows), (Edges{{4'999, 5'500}, {5'500, 5'600}, {99, 200}, {200, 400}}));
    EXPECT_EQ(slicer.counters().late_references, 0U);
}

}  // namespace
}  // namespace eventide
