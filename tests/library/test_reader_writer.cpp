// Recordings through the library: read whole, from a time on, and written again.
#include "tests/library/library_test.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include <unistd.h>

namespace eventide::test {
namespace {

class Recordings : public LibraryTest {};

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

TEST_F(Recordings, ComeBackAsTheyWereWritten) {
    EventReader reader{recording()};
    EventWriter events_alone{temp_ / "events.raw", reader.info(), {"evt3", false}};
    EventWriter all{temp_ / "all.aedat4", reader.info()};
    std::vector<Event> events;
    for (Batch batch; reader.read(batch);) {
        events.insert(events.end(), batch.events.begin(), batch.events.end());
        events_alone.write(batch);
        all.write(batch);
    }
    EXPECT_FALSE(std::filesystem::exists(temp_ / "all.aedat4")) << "not before it is whole";
    events_alone.finish();
    all.finish();
    EXPECT_EQ(events_alone.not_held(), 11U) << "images";
    EXPECT_EQ(all.not_held(), 0U);
    EXPECT_EQ(events_of(temp_ / "events.raw"), events);
    EXPECT_EQ(events_of(temp_ / "all.aedat4"), events);
    EXPECT_NE(error_of([&] { all.write(std::span<const Event>{events}); }).find("finish()"),
              std::string::npos);
    EventWriter text{temp_ / "events.txt", {"", "", "", 64, 48}};
    text.write(std::span<const Event>{events});
    text.finish();
    EventReader again{temp_ / "events.txt", {"", 64, 48}};
    EXPECT_EQ(again.width(), 64);
}

TEST_F(Recordings, OfAColourCameraSaySoWhenTheyComeBack) {
    Batch batch;
    batch.images.resize(1);
    batch.images[0].pixels = Array2<std::uint16_t>(48, 64);
    EventWriter writer{temp_ / "colour.aedat4",
                       {"DAVIS346", "00000007", "", 64, 48, ColourFilter::grbg}};
    writer.write(batch);
    writer.finish();
    EventReader reader{temp_ / "colour.aedat4"};
    EXPECT_EQ(reader.info().colour_filter, ColourFilter::grbg);
    EXPECT_EQ(reader.info().name, "DAVIS346");
    EXPECT_EQ(reader.info().serial, "00000007");
    ASSERT_TRUE(reader.read(batch));
    ASSERT_EQ(batch.images.size(), 1U);
    EXPECT_EQ(batch.images[0].filter, ColourFilter::grbg);
}

TEST_F(Recordings, HoldNoImageWhoseExposureEndsBeforeItBegins) {
    Batch batch;
    batch.images.resize(1);
    batch.images[0].pixels = Array2<std::uint16_t>(4, 6);
    batch.images[0].t = batch.images[0].exposure_begin = from_us(9);
    batch.images[0].exposure_end = from_us(8);
    EventWriter writer{temp_ / "images.aedat4", {"", "", "", 64, 48}};
    EXPECT_NE(error_of([&] { writer.write(batch); }).find("exposure_end not before"),
              std::string::npos);
    batch.images[0].exposure_end = from_us(9);
    writer.write(batch);
    writer.finish();
    EventReader reader{temp_ / "images.aedat4"};
    std::size_t images = 0;
    for (Batch read; reader.read(read);) images += read.images.size();
    EXPECT_EQ(images, 1U);
}

TEST_F(Recordings, AreWrittenInTheOrderOfTimeOnly) {
    const auto at = [](std::int64_t t) { return Event{from_us(t), 1, 2, Polarity::on}; };
    for (const std::string format : {"aedat4", "aedat3", "evt3", "text"}) {
        const std::string file = temp_ / ("ordered." + format);
        EventWriter writer{file, {"", "", "", 64, 48}, {format, false}};
        writer.write(std::vector{at(1000), at(1000), at(2000)});
        // A reader would leave out the second, or all until 2000 us.
        EXPECT_NE(error_of([&] {
                      writer.write(std::vector{at(3000), at(2500)});
                  }).find("expected events in order of time, found one at 2500 us after one"),
                  std::string::npos)
            << format;
        EXPECT_NE(error_of([&] { writer.write(std::vector{at(1999)}); }).find("2000 us"),
                  std::string::npos)
            << format;
        writer.write(std::vector{at(2000), at(4000)});
        writer.finish();
        const ReaderOptions size{"", format == "text" ? 64 : 0, format == "text" ? 48 : 0};
        EventReader reader{file, size};
        std::vector<Event> events;
        for (Batch batch; reader.read(batch);)
            events.insert(events.end(), batch.events.begin(), batch.events.end());
        EXPECT_EQ(events, (std::vector{at(1000), at(1000), at(2000), at(2000), at(4000)}))
            << format << ": what was refused is not in it";
    }
}

TEST_F(Recordings, AreWrittenWithinTheSensorOnly) {
    for (const std::string format : {"aedat4", "aedat3", "evt3", "text"}) {
        EventWriter writer{temp_ / ("within." + format), {"", "", "", 64, 48}, {format, false}};
        const std::vector<Event> outside{{from_us(1), 64, 2, Polarity::on}};
        EXPECT_NE(error_of([&] { writer.write(outside); }).find("within 64x48 px, found one at 64"),
                  std::string::npos)
            << format;
    }
}

TEST_F(Recordings, AreWrittenOfSensorsThatCoordinatesReachOnly) {
    for (const auto& [width, height] : {std::pair{0, 48}, {64, 0}, {65536, 48}, {64, 65536}})
        EXPECT_NE(error_of([&, w = width, h = height] {
                      EventWriter{temp_ / "a.txt", {"", "", "", w, h}};
                  })
                      .find("sensor size: expected 1 to 65535 px, found " + std::to_string(width) +
                            "x" + std::to_string(height)),
                  std::string::npos);
}

TEST_F(Recordings, AreWrittenAtTimesThatAreReadOnly) {
    constexpr std::int64_t kLast = Reconstructor::kFarthestTime;
    for (const std::string format : {"aedat4", "evt3", "text", "hdf5"}) {
        const std::string file = temp_ / ("far." + format);
        EventWriter writer{file, {"", "", "", 64, 48}, {format, false}};
        const std::vector<Event> far{{from_us(kLast + 1), 1, 2, Polarity::on}};
        EXPECT_NE(error_of([&] { writer.write(far); }).find("at most 2^60 us"), std::string::npos)
            << format;
    }
    const std::string file = temp_ / "last.h5";
    EventWriter writer{file, {"", "", "", 64, 48}, {"hdf5", false}};
    writer.write(std::vector<Event>{{from_us(kLast), 1, 2, Polarity::on}});
    writer.finish();
    EXPECT_EQ(events_of(file).size(), 1U);
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
    const SensorInfo sensor{"", "", "", 64, 48};
    EXPECT_NE(error_of([&] { EventWriter(temp_ / "a.jpeg", sensor); }).find("a.jpeg"),
              std::string::npos);
    EXPECT_NE(error_of([&] { EventWriter(temp_ / "a.raw", {}); }).find("found 0x0"),
              std::string::npos);
    EXPECT_NE(error_of([&] {
                  EventWriter(temp_ / "letter", sensor, {"aedat4", false});
              }).find("letter"),
              std::string::npos);
    EXPECT_EQ(read_text(temp_ / "letter"), "Dear Sir or Madam") << "what exists is not replaced";
}

}  // namespace
}  // namespace eventide::test
