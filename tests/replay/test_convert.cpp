// From format to format and back: nothing is lost that the formats hold, and what is not is said.
#include "replay/convert.h"

#include "src/core/error.h"
#include "tests/replay/recording_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <thread>

namespace eventide {
namespace {

TEST(Convert, EventsSurviveEveryWritableFormatAndTheWayBack) {
    const TestFolder folder;
    const auto events = some_events(20'000, 5'000'000);
    const std::string text = write_recording(folder.path("a.txt"), "text", events);
    for (const Format& format : all_formats()) {
        if (!format.is_written()) continue;
        SCOPED_TRACE(format.name);
        const std::string there = folder.path("b" + std::string(format.extension));
        const std::string back = folder.path("c.txt");
        const auto report = convert(*open_recording(text), there, format, {.overwrite = true});
        EXPECT_EQ(report.written.events, events.size());
        EXPECT_EQ(report.damaged.total(), 0U);
        EXPECT_EQ(open_recording(there)->info().format, format.name);
        convert(*open_recording(there), back, *find_format("text"), {.overwrite = true});
        EXPECT_TRUE(read_text(text) == read_text(back));
    }
}

TEST(Convert, OnlyWhatLiesBetweenTheLimitsIsWritten) {
    const TestFolder folder;
    const auto events = some_events(60'000);
    const std::string source = write_recording(folder.path("a.txt"), "text", events);
    ConvertOptions options;
    options.from = events[30'000].t;
    options.to = events[30'500].t;
    convert(*open_recording(source), folder.path("b.txt"), *find_format("text"), options);
    const auto kept = read_everything(*open_recording(folder.path("b.txt"))).events;
    ASSERT_FALSE(kept.empty());
    std::vector<Event> expected;
    for (const Event& event : events)
        if (event.t >= *options.from && event.t <= *options.to) expected.push_back(event);
    EXPECT_TRUE(kept == expected);
}

std::vector<Event> converted_up_to(SensorTime to, Recording& recording, const std::string& path) {
    ConvertOptions options;
    options.to = to;
    EXPECT_EQ(convert(recording, path, *find_format("text"), options).damaged.total(), 0U);
    return read_everything(*open_recording(path)).events;
}

TEST(Convert, RowsThatWaitToBeSortedAreWrittenUpToTheLimit) {
    const TestFolder folder;
    const auto events = some_events(60'000, 0, 200);
    OpenOptions sorting;
    sorting.text.reorder = std::chrono::seconds(2);
    const auto recording =
        open_recording(write_recording(folder.path("a.txt"), "text", events), sorting);
    const auto kept = converted_up_to(events[20'000].t, *recording, folder.path("b.txt"));
    EXPECT_GE(kept.size(), 20'001U);
    EXPECT_TRUE(std::equal(kept.begin(), kept.end(), events.begin()));
    EXPECT_LT(recording->position_bytes(), recording->size_bytes()) << "the rest is not read";
}

TEST(Convert, APartOfAQuietRecordingHasItsImages) {
    // Ten seconds in one batch, as a file of rows gives them.
    Batch quiet;
    for (int ms = 0; ms < 10'000; ++ms)
        quiet.events.push_back({from_us(1000 * ms), std::uint16_t(ms % 128), 5, Polarity::on});
    for (int ms = 50; ms < 10'000; ms += 100) {
        ReferenceImage image;
        image.t = image.exposure_begin = image.exposure_end = from_us(1000 * ms);
        image.pixels = Array2<std::uint16_t>(128, 128);
        quiet.images.push_back(image);
        quiet.imu.push_back({.t = image.t});
        quiet.triggers.push_back({image.t, Trigger::Kind::rising, 0});
    }
    const TestFolder folder;
    StreamHeader header;
    header.width = header.height = 128;
    ConvertOptions part;
    part.from = from_us(3'000'000);
    part.to = from_us(3'999'000);
    for (const std::string_view format : {"aedat4", "aedat3"}) {
        SCOPED_TRACE(format);
        const std::string path = folder.path(std::string(format));
        RecordingFile file(path, false, open_writer(format), header);
        file.write(quiet);
        file.finish();
        const Batch all = read_everything(*open_recording(path));
        EXPECT_TRUE(all.events == quiet.events);
        EXPECT_EQ(all.images.size(), 100U);
        const auto report = convert(*open_recording(path), folder.path("b"), *find_format("aedat4"),
                                    {part.from, part.to, true});
        EXPECT_TRUE((report.written == DataCounts{1000, 10, 10, 10}));
    }
}

TEST(Convert, ATriggerFarAheadEndsNothing) {
    const TestFolder folder;
    const auto events = some_events(60'000, 0, 200);
    StreamHeader header;
    header.width = header.height = 128;
    RecordingFile file(folder.path("a.aedat4"), false, open_writer("aedat4"), header);
    for (std::size_t i = 0; i < events.size(); i += 1000) {
        Batch batch;
        batch.events.assign(events.begin() + std::ptrdiff_t(i),
                            events.begin() + std::ptrdiff_t(i + 1000));
        if (i == 0) batch.triggers = {{from_us(std::int64_t{1} << 33), Trigger::Kind::rising, 0}};
        file.write(batch);
    }
    file.finish();
    const auto recording = open_recording(folder.path("a.aedat4"));
    EXPECT_GE(converted_up_to(events[30'000].t, *recording, folder.path("b.txt")).size(), 30'001U);
}

TEST(Convert, WhatTheTargetCannotHoldIsCounted) {
    const TestFolder folder;
    Batch batch;
    batch.events = some_events(10);
    ReferenceImage image;
    image.pixels = Array2<std::uint16_t>(2, 3);
    batch.images = {image, image};
    batch.imu = {ImuSample{}};
    batch.triggers = {Trigger{}};
    {
        StreamHeader header;
        header.width = header.height = 128;
        RecordingFile file(folder.path("a"), false, open_writer("aedat3"), header);
        file.write(batch);
        file.finish();
    }
    const auto report =
        convert(*open_recording(folder.path("a")), folder.path("b.txt"), *find_format("text"));
    EXPECT_EQ(report.written, (DataCounts{10, 0, 0, 0}));
    EXPECT_EQ(report.data.left_out(), (DataCounts{0, 2, 1, 1}));
}

TEST(Convert, TriggersOfAKindTheTargetLacksAreLeftOutAndTheOthersKept) {
    const TestFolder folder;
    Batch batch;
    batch.events = some_events(10);
    const SensorTime t = batch.events.back().t;
    batch.triggers = {{t, Trigger::Kind::rising, 0},
                      {t, Trigger::Kind::frame_begin, 0},
                      {t, Trigger::Kind::exposure_end, 0}};
    {
        StreamHeader header;
        header.width = header.height = 128;
        RecordingFile file(folder.path("a.aedat4"), false, open_writer("aedat4"), header);
        file.write(batch);
        file.finish();
    }
    const auto report = convert(*open_recording(folder.path("a.aedat4")), folder.path("b.raw"),
                                *find_format("evt3"));
    EXPECT_EQ(report.written, (DataCounts{10, 0, 0, 1}));
    EXPECT_EQ(report.data.left_out(), (DataCounts{0, 0, 0, 2}));
}

TEST(Convert, TriggersAnywhereBetweenTheEventsDoNotEndARunToRaw) {
    const TestFolder folder;
    const auto events = some_events(60'000);
    StreamHeader header;
    header.width = header.height = 128;
    RecordingFile file(folder.path("a.aedat4"), false, open_writer("aedat4"), header);
    for (std::size_t i = 0; i < events.size(); i += 1000) {
        Batch batch, trigger;
        batch.events.assign(events.begin() + std::ptrdiff_t(i),
                            events.begin() + std::ptrdiff_t(i + 1000));
        file.write(batch);
        // One ahead of the events of its time, one behind them.
        if (i == 1000) trigger.triggers = {{events[30'000].t, Trigger::Kind::rising, 0}};
        if (i == 50'000) trigger.triggers = {{events[5'000].t, Trigger::Kind::falling, 0}};
        file.write(trigger);
    }
    file.finish();
    const auto report = convert(*open_recording(folder.path("a.aedat4")), folder.path("b.raw"),
                                *find_format("evt3"));
    EXPECT_EQ(report.written, (DataCounts{60'000, 0, 0, 2}));
    EXPECT_EQ(report.data.late_triggers(), 1U);
    const Batch batch = read_everything(*open_recording(folder.path("b.raw")));
    EXPECT_TRUE(batch.events == events);
    ASSERT_EQ(batch.triggers.size(), 2U);
    EXPECT_EQ(batch.triggers[0].t, events[30'000].t);
    EXPECT_GT(batch.triggers[1].t, events[40'000].t);
}

TEST(Convert, AClockThatBeganAnewGoesOnWhereTheFormatCannotSayIt) {
    const TestFolder folder;
    const std::string source = folder.path("a.aedat4");
    std::size_t events = 0;
    {
        StreamHeader header;
        header.format = "aedat4";
        header.width = 240;
        header.height = 180;
        RecordingFile file{source, {}, *find_format("aedat4"), header};
        for (const std::int64_t begin : {5'000'000, 1'000'000}) {
            Batch batch;
            batch.events = some_events(1'000, begin);
            batch.triggers = {{batch.events.front().t, Trigger::Kind::timestamp_reset, 0}};
            events += batch.events.size();
            file.write(batch);
        }
        file.finish();
    }
    for (const Format& format : all_formats()) {
        if (!format.is_written()) continue;
        SCOPED_TRACE(format.name);
        const std::string file = folder.path("b" + std::string(format.extension));
        const auto report = convert(*open_recording(source), file, format, {.overwrite = true});
        EXPECT_EQ(report.data.restarts(), format.holds.clock_resets ? 0U : 1U);
        const Batch there = read_everything(*open_recording(file));
        EXPECT_EQ(there.events.size(), events);
        if (!format.holds.clock_resets) {
            EXPECT_TRUE(std::ranges::is_sorted(there.events, {}, &Event::t));
        }
    }
}

/// Ten events 10 ms apart from each of `begins` on, in ms, each time of a clock that began anew.
std::string write_clocks(const std::string& path, const std::vector<int>& begins_ms) {
    StreamHeader header;
    header.format = "aedat4";
    header.width = 240;
    header.height = 180;
    RecordingFile file{path, OutputOptions{.overwrite = true}, *find_format("aedat4"), header};
    for (const int begin : begins_ms) {
        Batch batch;
        for (int i = 0; i < 10; ++i)
            batch.events.push_back({from_us(1000 * (begin + 10 * i)), 1, 1, Polarity::on});
        batch.triggers = {{batch.events.front().t, Trigger::Kind::timestamp_reset, 0}};
        file.write(batch);
    }
    file.finish();
    return path;
}

TEST(Convert, APartIsOneOfTheClockThatTheRecordingBeginsWith) {
    const TestFolder folder;
    const std::string source = write_clocks(folder.path("a.aedat4"), {5000, 1000});
    const auto part = [&](std::optional<int> from_ms, std::optional<int> to_ms) {
        ConvertOptions how{.overwrite = true};
        if (from_ms) how.from = from_us(1000 * *from_ms);
        if (to_ms) how.to = from_us(1000 * *to_ms);
        const std::string file = folder.path("b.aedat4");
        convert(*open_recording(source), file, *find_format("aedat4"), how);
        const Batch batch = read_everything(*open_recording(file));
        return std::pair{batch.events.size(), batch.triggers.size()};
    };
    using Counts = std::pair<std::size_t, std::size_t>;
    EXPECT_EQ(part({}, {}), Counts(20, 2));
    EXPECT_EQ(part(5020, {}), Counts(18, 1)) << "and all of the clock that began anew";
    EXPECT_EQ(part(5020, 5040), Counts(3, 0)) << "which comes behind the end";
    EXPECT_EQ(part({}, 6000), Counts(20, 2)) << "which was not reached";
    EXPECT_EQ(part(6000, {}), Counts(0, 0)) << "which no clock reached";
    write_clocks(source, {1000, 1050});
    EXPECT_EQ(part(1100, {}), Counts(5, 0)) << "which only the second reached";
}

TEST(Convert, AFileThatExistsIsNotReplacedUnlessTold) {
    const TestFolder folder;
    const std::string source = folder.write("a.txt", "240 180\n0.100000 1 2 1\n");
    const std::string target = folder.write("b.txt", "precious");
    EXPECT_THROW(convert(*open_recording(source), target, *find_format("text")), Error);
    EXPECT_EQ(read_text(target), "precious");
    convert(*open_recording(source), target, *find_format("text"), {.overwrite = true});
    EXPECT_EQ(read_text(target), read_text(source));
    EXPECT_THROW(
        convert(*open_recording(source), folder.path("no/such/folder"), *find_format("text")),
        Error);
}

TEST(Convert, PipesAndDevicesAreThereAlready) {
    const TestFolder folder;
    const auto events = some_events(100);
    const std::string source = write_recording(folder.path("a.txt"), "text", events);
    EXPECT_EQ(convert(*open_recording(source), "/dev/null", *find_format("text")).written.events,
              100U);
    EXPECT_THROW(convert(*open_recording(source), "/dev/full", *find_format("text")), Error);

    // AEDAT4 goes back to write where its table is; in a pipe it cannot.
    const std::string pipe = folder.path("pipe");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    convert(*open_recording(source), pipe, *find_format("aedat4"));
    std::string bytes(std::size_t(1) << 16, ' ');
    bytes.resize(std::size_t(::read(reader, bytes.data(), bytes.size())));
    ::close(reader);
    EXPECT_TRUE(read_everything(*open_recording(folder.write("b", bytes))).events == events);
}

TEST(Convert, EndsWhereTheReaderOfAPipeWentAway) {
    const TestFolder folder;
    const auto handler = std::signal(SIGPIPE, SIG_IGN);  // as the program does
    const std::string source = write_recording(folder.path("a.txt"), "text", some_events(100'000));
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    const auto recording = open_recording(source);
    std::jthread reader([from = ends[0]] {
        char first = 0;
        EXPECT_EQ(::read(from, &first, 1), 1);
        ::close(from);
    });
    const std::string pipe = "/dev/fd/" + std::to_string(ends[1]);
    const ConvertReport report = convert(*recording, pipe, *find_format("text"));
    EXPECT_EQ(report.damaged.total(), 0U) << "half a record in hand is no damage";
    EXPECT_LT(recording->position_bytes(), recording->size_bytes()) << "the rest is not read";
    ::close(ends[1]);
    std::signal(SIGPIPE, handler);
}

}  // namespace
}  // namespace eventide
