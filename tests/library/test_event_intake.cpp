// What a caller pushes of a source that stood still while its clock was promised to go on.
#include "library/event_intake.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace eventide
