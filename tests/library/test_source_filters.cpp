// Filters behind readers and cameras are those of `eventide run --filter` and of `convert`.
#include "tests/library/library_test.h"

#include <algorithm>

namespace eventide::test {
namespace {

class FiltersOfSources : public LibraryTest {
protected:
    /// What is left of the rest of it.
    static std::vector<Event> rest_of(EventSource& source) {
        std::vector<Event> events;
        for (Batch batch; source.read(batch);)
            events.insert(events.end(), batch.events.begin(), batch.events.end());
        return events;
    }
};

const std::vector<std::string> kFilters{"region:9,6,40x32", "refractory:2ms", "subsample:2x1",
                                        "time:50ms..200ms", "transpose"};

TEST_F(FiltersOfSources, LeaveTheEventsThatConvertLeaves) {
    EventReader reader{recording()};
    std::vector<std::string> arguments{"convert", recording(), "left.aedat4"};
    for (const std::string& filter : kFilters) {
        reader.add_filter(filter);
        arguments.insert(arguments.end(), {"--filter", filter});
    }
    EXPECT_EQ(reader.width(), 48);
    EXPECT_EQ(reader.height(), 32);
    const Result converted = eventide(arguments);
    ASSERT_EQ(converted.exit_code, 0) << converted.error;
    const std::vector<Event> left = rest_of(reader);
    EXPECT_EQ(left, events_of(temp_ / "left.aedat4"));
    EXPECT_GT(left.size(), 100U);
    EXPECT_LT(left.size(), events_of(recording()).size() / 2);
}

TEST_F(FiltersOfSources, GiveTheFramesOfARunWithThem) {
    EventReader reader{recording()};
    auto arguments = repeatable_arguments("7ms", 1);
    for (const std::string filter : {"region:9,6,40x32", "flip:y"}) {
        reader.add_filter(filter);
        arguments.insert(arguments.end(), {"--filter", filter});
    }
    Reconstructor reconstructor{model(), reader.width(), reader.height(), repeatable("7ms", 1)};
    std::string frames;
    for (Frame frame; read_frame(reader, reconstructor, frame);) append_frame(frame, frames);
    EXPECT_GT(reconstructor.counters().used_images, 5U);
    EXPECT_TRUE(frames == frames_of_run(arguments));
}

TEST_F(FiltersOfSources, CountTimesFromTheFirstEventOfTheRecordingAlsoAfterASeek) {
    const std::vector<Event> all = events_of(recording());
    const SensorTime end = all.front().t + SensorDuration{200'000};
    EventReader reader{recording()};
    reader.add_filter("time:..200ms");
    reader.seek(all.front().t + SensorDuration{150'000});
    const std::vector<Event> events = rest_of(reader);
    ASSERT_FALSE(events.empty());
    EXPECT_LE(events.back().t, end);
    EXPECT_GT(events.back().t, end - SensorDuration{5'000});
}

TEST_F(FiltersOfSources, RememberNothingOfWhatWasReadBeforeASeek) {
    const SensorTime middle = events_of(recording()).front().t + SensorDuration{150'000};
    for (const std::string filter : {"refractory:20ms", "background-activity:5ms", "subsample:7",
                                     "flicker", "hot-pixels:learn", "time:100ms..200ms"}) {
        EventReader fresh{recording()}, reader{recording()};
        fresh.add_filter(filter);
        reader.add_filter(filter);
        const std::vector<Event> all = rest_of(fresh);
        rest_of(reader);
        reader.seek(SensorTime::min());
        EXPECT_EQ(rest_of(reader), all) << filter;
        EventReader sought{recording()};
        sought.add_filter(filter);
        sought.seek(middle);
        reader.seek(middle);
        EXPECT_EQ(rest_of(reader), rest_of(sought)) << filter;
    }
}

TEST_F(FiltersOfSources, OfACameraLeaveWhatTheySay) {
    EventCamera camera{"sim:demo?seconds=0.1&size=64x48&speed=max"};
    camera.add_filter("polarity:on");
    camera.add_filter("subsample:2x2");
    EXPECT_EQ(camera.width(), 32);
    EXPECT_EQ(camera.height(), 24);
    const std::vector<Event> events = rest_of(camera);
    ASSERT_GT(events.size(), 50U);
    EXPECT_TRUE(std::ranges::all_of(
        events, [](const Event& e) { return e.polarity == Polarity::on && e.x < 32 && e.y < 24; }));
}

TEST_F(FiltersOfSources, AreRefusedInWordsAndThenChangeNothing) {
    EventReader reader{recording()};
    reader.add_filter("transpose");
    EXPECT_NE(error_of([&] { reader.add_filter("blur"); }).find("found 'blur'"), std::string::npos);
    EXPECT_NE(error_of([&] { reader.add_filter("region:50,0,8x8"); }).find("48x64"),
              std::string::npos)
        << "a filter sees what those before it leave";
    EXPECT_EQ(reader.width(), 48);
    Batch batch;
    ASSERT_TRUE(reader.read(batch));
    EXPECT_NE(error_of([&] { reader.add_filter("flip:x"); }).find("nothing has been read from"),
              std::string::npos);
}

}  // namespace
}  // namespace eventide::test
