// Recordings through the library: read whole, and from a time on.
#include "tests/library/library_test.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include <unistd.h>

namespace eventide::test {
namespace {

using Recordings = LibraryTest;

/// What is left to read.
Batch rest_of(EventReader& reader) {
    Batch rest;
    for (Batch batch; reader.read(batch);) {
        std::ranges::copy(batch.events, std::back_inserter(rest.events));
        std::ranges::copy(batch.images, std::back_inserter(rest.images));
    }
    return rest;
}

Batch all_of(const std::string& file) {
    EventReader reader{file};
    return rest_of(reader);
}

TEST_F(Recordings, TellTheirSensorTheirTimesAndTheirImages) {
    EventReader reader{recording()};
    EXPECT_EQ(reader.width(), 64);
    EXPECT_EQ(reader.height(), 48);
    EXPECT_EQ(reader.info().format, "aedat4");
    EXPECT_EQ(reader.clock(), std::nullopt);
    std::vector<Event> events;
    std::size_t images = 0;
    for (Batch batch; reader.read(batch);) {
        events.insert(events.end(), batch.events.begin(), batch.events.end());
        images += batch.images.size();
    }
    EXPECT_GT(events.size(), 1000U);
    EXPECT_EQ(images, 11U);
    EXPECT_EQ(reader.damaged(), 0U);
    Batch left;
    left.events = events;
    EXPECT_FALSE(reader.read(left)) << "the end stays the end";
    EXPECT_TRUE(left.events.empty()) << "a batch is emptied before it is filled";
    EXPECT_GE(reader.clock(), events.back().t);
    const auto span = EventReader{recording()}.span();
    ASSERT_TRUE(span);
    EXPECT_EQ(span->begin, events.front().t);
    EXPECT_EQ(span->end, events.back().t);
}

TEST_F(Recordings, OfSeveralCamerasGiveTheEventsOfTheStreamThatIsWanted) {
    ReaderOptions options;
    options.stream = "0";
    EventReader reader{recording(), options};
    EXPECT_EQ(rest_of(reader).events, all_of(recording()).events);
    options.stream = "7";
    try {
        EventReader{recording(), options};
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_NE(std::string{error.what()}.find("expected an event stream 7, found 0 ("),
                  std::string::npos)
            << error.what();
    }
}

TEST_F(Recordings, AreReadFromATimeOn) {
    const Batch all = all_of(recording());
    const SensorTime middle = all.events[all.events.size() / 2].t;
    EventReader reader{recording()};
    for (Batch batch; reader.read(batch);) continue;
    reader.seek(middle);
    const Batch rest = rest_of(reader);
    const auto is_early = [&](const auto& it) { return it.t < middle; };
    const auto first = std::ranges::find_if_not(all.events, is_early);
    EXPECT_EQ(rest.events, std::vector<Event>(first, all.events.end()));
    EXPECT_LT(rest.images.size(), all.images.size());
    EXPECT_TRUE(std::ranges::none_of(rest.images, is_early));
    EXPECT_EQ(rest.images.back(), all.images.back());
    reader.seek(all.events.back().t + SensorDuration{1});
    EXPECT_TRUE(rest_of(reader).events.empty());
}

TEST_F(Recordings, AreReadFromTheBeginningWhereverTheyAre) {
    const Batch all = all_of(recording());
    for (int batches = 1; batches < 5; ++batches) {
        EventReader reader{recording()};
        Batch batch;
        for (int i = 0; i < batches; ++i) ASSERT_TRUE(reader.read(batch));
        reader.seek(all.events.front().t);
        EXPECT_TRUE(rest_of(reader).events == all.events) << batches;
    }
}

TEST_F(Recordings, CountDamageEachTimeItIsRead) {
    write_text(temp_ / "log.txt", "64 48\n0.1 1 2 1\n0.2 3 4 0\n0.3 99 6 1\n0.4 7 8 1\n");
    EventReader reader{temp_ / "log.txt"};
    EXPECT_EQ(rest_of(reader).events.size(), 3U);
    EXPECT_EQ(reader.damaged(), 1U);
    reader.seek(from_us(0));
    EXPECT_EQ(rest_of(reader).events.size(), 3U);
    EXPECT_EQ(reader.damaged(), 2U);
}

TEST_F(Recordings, ThatCannotGoBackLoseNothingByASeek) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const auto write = [&](const std::string& text) {
        EXPECT_EQ(::write(ends[1], text.data(), text.size()), ssize_t(text.size()));
    };
    write("64 48\n0.1 1 2 1\n0.2 3 4 0\n0.3 5 6 1\n0.4 7");
    EventReader reader{"/dev/fd/" + std::to_string(ends[0])};
    Batch batch;
    ASSERT_TRUE(reader.read(batch));
    std::vector<Event> events = batch.events;
    reader.seek(from_us(0));
    write(" 8 1\n0.5 9 10 0\n");
    ::close(ends[1]);
    while (reader.read(batch))
        events.insert(events.end(), batch.events.begin(), batch.events.end());
    EXPECT_NE(error_of([&] { reader.span(); }).find("found a pipe"), std::string::npos);
    ::close(ends[0]);
    ASSERT_EQ(events.size(), 5U);
    EXPECT_EQ(events[3], (Event{from_us(400'000), 7, 8, Polarity::on}));
    EXPECT_EQ(reader.damaged(), 0U);
}

/// A recording in a pipe that stays open, and in which nothing more comes.
class OpenPipe {
public:
    OpenPipe() {
        EXPECT_EQ(::pipe(ends_), 0);
        const std::string text = "64 48\n0.1 1 2 1\n0.2 3 4 0\n0.3 5 6 1\n0.4 7 8 1\n";
        EXPECT_EQ(::write(ends_[1], text.data(), text.size()), ssize_t(text.size()));
    }
    ~OpenPipe() {
        for (const int end : ends_) ::close(end);
    }
    OpenPipe(const OpenPipe&) = delete;
    OpenPipe& operator=(const OpenPipe&) = delete;
    std::string name() const { return "/dev/fd/" + std::to_string(ends_[0]); }

private:
    int ends_[2];
};

TEST_F(Recordings, OfAPipeThatWaitsEndWhenTheyAreStopped) {
    const OpenPipe pipe;
    EventReader reader{pipe.name()};
    Batch batch;
    ASSERT_TRUE(reader.read(batch));
    std::size_t events = batch.events.size();
    std::jthread stopper{[&] { reader.stop(); }};
    while (reader.read(batch)) events += batch.events.size();
    EXPECT_EQ(events, 4U) << "what was read is given";
    EXPECT_FALSE(reader.read(batch)) << "for good";
}

TEST_F(Recordings, OfAPipeThatWaitsEndWithTheirPipeline) {
    struct OneFrame final : FrameSink {
        bool write(const Frame&) override { return false; }
    };
    const OpenPipe pipe;
    EventReader reader{pipe.name()};
    OneFrame sink;
    EventPipeline pipeline{reader, {&sink}, model(), {.frames = repeatable("7ms", 0)}};
    pipeline.run();
    EXPECT_EQ(pipeline.counters().frames, 1U);
}

TEST_F(Recordings, InAFileAreReadOnAfterAStop) {
    EventReader reader{recording()};
    reader.stop();
    Batch batch;
    EXPECT_TRUE(reader.read(batch));
}

TEST_F(Recordings, OfAnotherSizeThanTheReconstructorsAreRefused) {
    EventReader reader{recording()};
    Reconstructor other{model(), reader.width() / 2, reader.height(), repeatable("20ms", 0)};
    Frame frame;
    EXPECT_NE(error_of([&] { read_frame(reader, other, frame); }).find("as of the reconstructor"),
              std::string::npos);
}

TEST_F(Recordings, ThatAreNoneAreRefusedInWords) {
    write_text(temp_ / "letter", "Dear Sir or Madam");
    EXPECT_NE(error_of([&] { EventReader{temp_ / "letter"}; }, ErrorKind::input).find("letter"),
              std::string::npos);
    EXPECT_NE(error_of([&] { EventReader{temp_ / "none"}; }, ErrorKind::input).find("none"),
              std::string::npos);
    EXPECT_NE(error_of([&] {
                  EventReader(recording(), {"", 5, 0});
              }).find("5x0"),
              std::string::npos);
}

}  // namespace
}  // namespace eventide::test
