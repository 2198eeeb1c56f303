// What a caller pushes: of a source that stood still while its clock was promised to go on, and
// images among events.
#include "library/event_intake.h"

#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

namespace eventide {
namespace {

constexpr std::int64_t kMs = 1000;

SlicerSettings windows_of_10_ms() {
    SlicerSettings settings;
    settings.width = SensorDuration{10 * kMs};
    return settings;
}

/// After 20 s in which a sender was paused and advance() went on, it sends 3 s more.
template <typename Push>
ReconstructorCounters after_a_pause(Push push) {
    ReconstructorCounters counters;
    EventIntake intake{windows_of_10_ms(), 64, 48, nullptr, counters};
    std::uint64_t cut = 0;
    const auto send = [&](std::int64_t t_us, std::int64_t host_us) {
        push(intake, Event{from_us(t_us), 1, 1, Polarity::on},
             HostTime{std::chrono::microseconds{host_us}});
        for (EventWindow window; intake.next(window);) ++cut;
    };
    send(kMs, 0);
    intake.advance(from_us(20'000 * kMs));
    for (EventWindow window; intake.next(window);) ++cut;
    const std::uint64_t of_pause = cut;
    for (std::int64_t t = 5 * kMs; t < 3'000 * kMs; t += 5 * kMs) send(kMs + t, 20'000 * kMs + t);
    EXPECT_GT(cut, of_pause + 190);
    return counters;
}

TEST(EventIntake, GoesOnWithASourceThatStoodStill) {
    const auto as_events = [](EventIntake& intake, const Event& event, HostTime arrived) {
        intake.push(std::span{&event, 1}, arrived);
    };
    const auto as_batch = [](EventIntake& intake, const Event& event, HostTime arrived) {
        Batch batch;
        batch.events = {event};
        intake.push(batch, arrived);
    };
    for (const ReconstructorCounters& counters :
         {after_a_pause(as_events), after_a_pause(as_batch)}) {
        EXPECT_EQ(counters.time_resets, 1U);
        EXPECT_LE(counters.late, 200U) << "of the first second";
        EXPECT_EQ(counters.time_backwards, 0U);
    }
}

/// Batches with images that come late, and a clock that begins anew now and then.
std::vector<Batch> batches_with_images(std::uint32_t seed) {
    std::mt19937 random{seed};
    std::vector<Batch> batches(60);
    std::int64_t t = 1'000'000;
    std::uint16_t number = 0;
    for (Batch& batch : batches) {
        if (random() % 20 == 0) t -= 400 * kMs;
        for (auto i = random() % 9; i > 0; --i)
            batch.events.push_back({from_us(t += 1 + random() % (4 * kMs)), 1, 1, Polarity::on});
        for (auto i = random() % 3; i > 0; --i) {
            ReferenceImage& image = batch.images.emplace_back();
            image.t = from_us(t - std::int64_t(random() % (20 * kMs)));
            image.pixels = Array2<std::uint16_t>(1, 1);
            image.pixels(0, 0) = ++number;
        }
    }
    return batches;
}

using WindowAndImages = std::pair<Window, std::vector<int>>;

/// The windows, and the images new to each. `taken(i)`: whether windows are taken after batch i.
template <typename Taken>
std::vector<WindowAndImages> windows_of(const std::vector<Batch>& batches, WindowRule rule,
                                        Taken taken) {
    SlicerSettings settings = windows_of_10_ms();
    settings.rule = rule;
    if (rule == WindowRule::count) settings.events = 7;
    ReconstructorCounters counters;
    EventIntake intake{settings, 64, 48, nullptr, counters};
    intake.hold_images();
    std::vector<WindowAndImages> windows;
    const auto take = [&] {
        for (EventWindow window; intake.next(window);) {
            windows.push_back({window.window, {}});
            while (const auto image = intake.next_image())
                windows.back().second.push_back(image->pixels(0, 0));
        }
    };
    for (std::size_t i = 0; i < batches.size(); ++i) {
        intake.push(batches[i]);
        if (taken(i)) take();
    }
    intake.finish({});
    take();
    return windows;
}

/// A window knows the images that had come when it could first be cut, however late it is taken.
TEST(EventIntake, WhichImagesAWindowKnowsDoesNotHangOnWhenItIsTaken) {
    for (const WindowRule rule : {WindowRule::duration, WindowRule::count})
        for (std::uint32_t seed = 0; seed < 40; ++seed) {
            const std::vector<Batch> batches = batches_with_images(seed);
            const auto at_once = windows_of(batches, rule, [](std::size_t) { return true; });
            std::size_t images = 0;
            for (const WindowAndImages& window : at_once) images += window.second.size();
            ASSERT_GT(images, 20U);
            std::mt19937 random{seed};
            EXPECT_EQ(windows_of(batches, rule, [&](std::size_t) { return random() % 5 == 0; }),
                      at_once)
                << seed;
            EXPECT_EQ(windows_of(batches, rule, [](std::size_t) { return false; }), at_once)
                << seed;
        }
}

/// Some in one, images in their places.
std::vector<Batch> joined(const std::vector<Batch>& batches, std::uint32_t seed) {
    std::mt19937 random{seed};
    std::vector<Batch> some;
    for (const Batch& batch : batches) {
        if (some.empty() || random() % 3 == 0) some.emplace_back();
        Batch& into = some.back();
        for (const ReferenceImage& image : batch.images) into.add_image(image);
        into.events.insert(into.events.end(), batch.events.begin(), batch.events.end());
    }
    return some;
}

TEST(EventIntake, WhichImagesAWindowKnowsDoesNotHangOnHowTheStreamIsSplit) {
    for (const WindowRule rule : {WindowRule::duration, WindowRule::count})
        for (std::uint32_t seed = 0; seed < 40; ++seed) {
            const std::vector<Batch> batches = batches_with_images(seed);
            const auto always = [](std::size_t) { return true; };
            EXPECT_EQ(windows_of(joined(batches, seed), rule, always),
                      windows_of(batches, rule, always))
                << seed;
        }
}

/// What the windows above know hangs on it if it is asked of the newest event alone.
TEST(EventIntake, AnImageIsNewToTheWindowThatWasOpenWhenItCame) {
    ReconstructorCounters counters;
    EventIntake intake{windows_of_10_ms(), 64, 48, nullptr, counters};
    intake.hold_images();
    const auto push = [&](std::int64_t t, bool image) {
        Batch batch;
        batch.events = {{from_us(t), 1, 1, Polarity::on}};
        if (image) batch.images.emplace_back().t = from_us(2 * kMs);
        intake.push(batch);
    };
    push(kMs, false);
    push(25 * kMs, false);
    push(26 * kMs, true);
    push(55 * kMs, false);
    int known_to = 0, number = 0;
    for (EventWindow window; intake.next(window);) {
        ++number;
        while (intake.next_image()) known_to = number;
    }
    EXPECT_EQ(known_to, 3) << "the first two had been cut";
}

Event event_at(std::int64_t t_us) {
    return {from_us(t_us), 1, 1, Polarity::on};
}

ReferenceImage image_at(SensorTime t) {
    ReferenceImage image;
    image.t = t;
    image.pixels = Array2<std::uint16_t>(1, 1);
    return image;
}

TEST(EventIntake, AfterAResetNothingIsKnownOfTheStreamBefore) {
    ReconstructorCounters counters;
    EventIntake intake{windows_of_10_ms(), 64, 48, nullptr, counters};
    intake.hold_images();
    Batch batch;
    batch.events = {event_at(5'000 * kMs)};
    batch.add_image(image_at(from_us(5'000 * kMs)));
    intake.push(batch);
    ASSERT_TRUE(intake.has_images());
    intake.reset();
    EXPECT_FALSE(intake.has_images());
    const Event earlier = event_at(kMs);
    intake.push(std::span{&earlier, 1});
    EXPECT_EQ(counters.time_backwards, 0U);
}

TEST(EventIntake, AStreamWithoutEventsHasNoWindowsWhereverItEnds) {
    ReconstructorCounters counters;
    EventIntake intake{windows_of_10_ms(), 64, 48, nullptr, counters};
    intake.finish(from_us(1'000 * kMs));
    EventWindow window;
    EXPECT_FALSE(intake.next(window));
}

TEST(EventIntake, AnImageOfATimeThatNoStreamHasIsCountedAndLeftOut) {
    ReconstructorCounters counters;
    EventIntake intake{windows_of_10_ms(), 64, 48, nullptr, counters};
    intake.hold_images();
    Batch batch;
    batch.add_image(image_at(SensorTime::max()));
    intake.push(batch);
    EXPECT_EQ(counters.bad_time, 1U);
    EXPECT_FALSE(intake.has_images());
}

TEST(EventIntake, ImagesEndWindowsWhereTheyAreAskedTo) {
    SlicerSettings settings = windows_of_10_ms();
    settings.rule = WindowRule::reference;
    ReconstructorCounters counters;
    EventIntake intake{settings, 64, 48, nullptr, counters};
    for (const std::int64_t t : {3 * kMs, 40 * kMs, 90 * kMs}) {
        Batch batch;
        batch.events = {event_at(t - kMs)};
        batch.add_image(image_at(from_us(t)));
        batch.events.push_back(event_at(t + kMs));
        intake.push(batch);
    }
    std::vector<std::int64_t> ends;
    for (EventWindow window; intake.next(window);) ends.push_back(to_us(window.window.end) / kMs);
    EXPECT_EQ(ends, (std::vector<std::int64_t>{3, 40, 90}));
}

}  // namespace
}  // namespace eventide
