// Sources and sinks of a user around the library's pipeline.
#include "tests/library/library_test.h"

#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>
#include <thread>

namespace eventide::test {
namespace {

/// Frames as `eventide run` writes them.
class Collector : public FrameSink {
public:
    explicit Collector(int most = 1 << 30) : most_(most) {}
    bool write(const Frame& frame) override {
        append_frame(frame, bytes);
        return ++frames < most_;
    }
    void close() override { ++closed; }

    std::string bytes;
    int frames = 0, closed = 0;

private:
    const int most_;
};

/// Events out of memory, some at a time.
class EventsInMemory : public EventSource {
public:
    EventsInMemory(std::vector<Event> events, std::size_t per_batch)
        : info_{.name = "memory", .serial = "", .format = "", .width = 64, .height = 48},
          events_(std::move(events)),
          per_batch_(per_batch) {}
    const SensorInfo& info() const noexcept override { return info_; }
    bool read(Batch& batch) override {
        batch.clear();
        if (at_ == fails_at) throw std::runtime_error("the cable came off");
        if (at_ == events_.size()) return false;
        const std::size_t end = std::min(at_ + per_batch_, events_.size());
        batch.events.assign(events_.begin() + std::ptrdiff_t(at_),
                            events_.begin() + std::ptrdiff_t(end));
        at_ = end;
        return true;
    }

    std::size_t fails_at = std::size_t(-1);

protected:
    SensorInfo info_;

private:
    std::vector<Event> events_;
    std::size_t per_batch_, at_ = 0;
};

class Pipelines : public LibraryTest {
protected:
    static PipelineOptions options(const std::string& window, int lookahead, bool sequential) {
        return {.frames = repeatable(window, lookahead), .sequential = sequential};
    }
};

/// A DAVIS gives an image when it has been read out, and so long after its time.
TEST_F(Pipelines, GiveTheFramesOfAReconstructorWhereTheFirstImageComesLate) {
    class LateImage final : public EventsInMemory {
    public:
        using EventsInMemory::EventsInMemory;
        bool read(Batch& batch) override {
            if (!EventsInMemory::read(batch)) return false;
            if (++batches_ == 12) {
                ReferenceImage image;
                image.t = image.exposure_begin = image.exposure_end = batch.events.front().t;
                image.pixels = Array2<std::uint16_t>(48, 64);
                for (int x = 0; x < 64; ++x)
                    for (int y = 0; y < 48; ++y) image.pixels(y, x) = std::uint16_t(1000 * x);
                batch.add_image(std::move(image));
            }
            return true;
        }

    private:
        int batches_ = 0;
    };
    const std::vector<Event> events = events_of(recording());
    for (const int lookahead : {0, 2}) {
        LateImage source{events, 100}, again{events, 100};
        Collector sink;
        EventPipeline pipeline{source, {&sink}, model(), options("5ms", lookahead, true)};
        pipeline.run();
        Reconstructor reconstructor = LibraryTest::reconstructor(repeatable("5ms", lookahead));
        std::string frames;
        for (Frame frame; read_frame(again, reconstructor, frame);) append_frame(frame, frames);
        EXPECT_EQ(reconstructor.counters().used_images, 1U);
        EXPECT_TRUE(sink.bytes == frames) << lookahead;
    }
}

TEST_F(Pipelines, OfARecordingGiveTheFramesOfEventideRun) {
    for (const bool sequential : {false, true}) {
        EventReader reader{recording()};
        Collector sink;
        EventPipeline pipeline{reader, {&sink}, model(), options("auto", 2, sequential)};
        pipeline.run();
        const std::string expected = frames_of_run(repeatable_arguments("auto", 2));
        ASSERT_GT(expected.size(), 30U * 64 * 48 * 8);
        EXPECT_TRUE(sink.bytes == expected) << sink.bytes.size() << " for " << expected.size();
        EXPECT_EQ(sink.closed, 1);
        EXPECT_EQ(pipeline.counters().frames, std::uint64_t(sink.frames));
        EXPECT_EQ(pipeline.counters().lost_batches, 0U);
    }
}

TEST_F(Pipelines, OfAUsersSourceGiveTheFramesOfTheReconstructor) {
    const std::vector<Event> events = events_of(recording());
    Reconstructor reconstructor = this->reconstructor(repeatable("7ms", 1));
    reconstructor.push(events);
    reconstructor.finish();
    std::string expected;
    append_frames(reconstructor, expected);
    for (const std::size_t per_batch : {std::size_t{57}, std::size_t{4000}, events.size()}) {
        EventsInMemory source{events, per_batch};
        Collector first, second;
        EventPipeline pipeline{source, {&first, &second}, model(), options("7ms", 1, false)};
        pipeline.run();
        EXPECT_TRUE(first.bytes == expected) << per_batch;
        EXPECT_TRUE(second.bytes == expected) << per_batch;
        EXPECT_EQ(pipeline.counters().events, events.size());
    }
}

TEST_F(Pipelines, OfACameraEndWhenASinkWantsNoMore) {
    EventCamera camera{"sim:demo?size=64x48&speed=1"};
    EXPECT_TRUE(camera.is_live());
    Collector sink{5};
    EventPipeline pipeline{camera, {&sink}, model(), options("10ms", 0, false)};
    pipeline.run();
    EXPECT_EQ(sink.frames, 5);
    EXPECT_EQ(sink.closed, 1);
}

TEST_F(Pipelines, StopFromAnotherThread) {
    EventCamera camera{"sim:demo?size=64x48&speed=1"};
    Collector sink;
    EventPipeline pipeline{camera, {&sink}, model(), options("10ms", 0, false)};
    std::jthread stopper{[&] {
        while (pipeline.counters().frames == 0) std::this_thread::yield();
        pipeline.stop();
    }};
    pipeline.run();
    EXPECT_GT(sink.frames, 0);
}

TEST_F(Pipelines, ThrowWhatASourceThrowsAndCloseTheSinks) {
    EventsInMemory source{events_of(recording()), 1000};
    source.fails_at = 3000;
    Collector sink;
    EventPipeline pipeline{source, {&sink}, model(), options("7ms", 0, false)};
    try {
        pipeline.run();
        ADD_FAILURE() << "no error";
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "the cable came off");
    }
    EXPECT_EQ(sink.closed, 1);
    EXPECT_THAT(error_of([&] { pipeline.run(); }), testing::HasSubstr("one run"));
}

TEST_F(Pipelines, LeaveOutAndCountEventsThatMakeNoSense) {
    std::vector<Event> events = events_of(recording());
    const std::size_t sound = events.size();
    events.insert(events.begin() + 100, {events[99].t, 64, 0, Polarity::on});
    events.insert(events.begin() + 200, {events[199].t, 0, 48, Polarity::on});
    events.push_back({from_us((std::int64_t{1} << 60) + 1), 0, 0, Polarity::on});
    EventsInMemory source{events, 512};
    Collector sink;
    EventPipeline pipeline{source, {&sink}, model(), options("7ms", 0, false)};
    pipeline.run();
    EXPECT_EQ(pipeline.counters().damaged, 3U);
    EXPECT_EQ(pipeline.counters().events, sound);
}

/// Says of the newest batch, also after the end, that data were lost before it.
class EventsAfterAGap final : public EventsInMemory {
public:
    using EventsInMemory::EventsInMemory;
    bool gap_before() const noexcept override { return true; }
};

TEST_F(Pipelines, CountAGapBeforeTheLastBatchOnce) {
    const std::vector<Event> events = events_of(recording());
    EventsAfterAGap source{events, events.size()};
    Collector sink;
    EventPipeline pipeline{source, {&sink}, model(), options("7ms", 0, false)};
    pipeline.run();
    EXPECT_EQ(pipeline.counters().gaps, 1U);
}

class Sizeless final : public EventsInMemory {
public:
    Sizeless() : EventsInMemory({}, 1) { info_.width = 0; }
};

TEST_F(Pipelines, RefuseWhatCannotRun) {
    Sizeless sizeless;
    EventsInMemory source{{}, 1};
    Collector sink;
    const auto made = [&](EventSource& from, FrameSink* to, const PipelineOptions& with) {
        return error_of([&] { EventPipeline{from, {to}, model(), with}; });
    };
    EXPECT_THAT(made(sizeless, &sink, {}), testing::HasSubstr("sensor width"));
    EXPECT_THAT(made(source, nullptr, {}), testing::HasSubstr("null pointer"));
    EXPECT_THAT(made(source, &sink, {.frames = {.lookahead = 9}}), testing::HasSubstr("lookahead"));
    EXPECT_THAT(made(source, &sink, {.frames = {.fps = "many"}}), testing::HasSubstr("many"));
    // Unlimited, a user might think; in nanoseconds it would have been less than nothing.
    for (const auto latency : {std::chrono::microseconds::max(), std::chrono::microseconds{-1}})
        EXPECT_THAT(made(source, &sink, {.latency = latency}),
                    testing::HasSubstr("latency: expected 0 to 1000000 s, found"));
}

/// Tells nanoseconds where microseconds are meant, for example.
class EventsWithAFarClock final : public EventsInMemory {
public:
    EventsWithAFarClock(std::vector<Event> events, bool live)
        : EventsInMemory(std::move(events), 1000), live_(live) {}
    std::optional<SensorTime> clock() const override {
        return from_us(std::numeric_limits<std::int64_t>::max());
    }
    bool is_live() const noexcept override { return live_; }

private:
    const bool live_;
};

TEST_F(Pipelines, RefuseAClockThatIsNone) {
    for (const bool live : {false, true})
        for (const bool sequential : {false, true}) {
            EventsWithAFarClock source{events_of(recording()), live};
            Collector sink;
            EventPipeline pipeline{source, {&sink}, model(), options("7ms", 0, sequential)};
            EXPECT_THAT(error_of([&] { pipeline.run(); }),
                        testing::HasSubstr("clock of the source: expected a time of at most 2^60"));
            EXPECT_EQ(sink.closed, 1);
        }
}

}  // namespace
}  // namespace eventide::test
