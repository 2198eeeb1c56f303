// Recordings are opened by what they contain, and refused with a word on why.
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "tests/replay/made_formats.h"

#include <gmock/gmock.h>
#include <string>

namespace eventide {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// What opening says; empty when it does not refuse.
std::string refusal(const std::string& path, const OpenOptions& options = {},
                    ErrorKind kind = ErrorKind::input) {
    try {
        open_recording(path, options);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    return {};
}

TEST(OpenRecording, TheContentCountsAndNotTheName) {
    const TestFolder folder;
    const auto events = some_events(100);
    for (const char* name : {"a.raw", "a.aedat4", "a.txt", "a"}) {
        for (const char* format : {"text", "aedat3"}) {
            const auto recording =
                open_recording(write_recording(folder.path(name), format, events));
            EXPECT_EQ(recording->info().format, format);
            EXPECT_EQ(recording->info().width, 128);
            EXPECT_TRUE(read_everything(*recording).events == events);
        }
    }
}

TEST(OpenRecording, SourcesOfAedat3ThatAreLeftOutAreNamed) {
    const TestFolder folder;
    std::string bytes = read_text(write_recording(folder.path("a"), "aedat3", some_events(100)));
    bytes.insert(bytes.find("#!END-HEADER"), "#Source 7: DAVIS240C\r\n");
    const auto recording = open_recording(folder.write("b", bytes));
    EXPECT_EQ(read_everything(*recording).events.size(), 100U);
    ASSERT_EQ(recording->remarks().size(), 1U);
    EXPECT_THAT(recording->remarks()[0],
                HasSubstr("the events of source 7 (DAVIS240C) are left out, those of source "));
    EXPECT_THAT(recording->remarks()[0], HasSubstr("--input-stream 7 "));
    OpenOptions options;
    options.stream = "7";
    const auto other = open_recording(folder.path("b"), options);
    EXPECT_EQ(other->info().name, "DAVIS240C");
    EXPECT_TRUE(read_everything(*other).events.empty()) << "it has no packets";
}

TEST(OpenRecording, AStreamOfAFormatOfOneCameraIsRefused) {
    const TestFolder folder;
    OpenOptions options;
    options.stream = "/events";
    for (const char* format : {"text", "evt3"}) {
        try {
            open_recording(write_recording(folder.path(format), format, some_events(100)), options);
            FAIL() << format;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_THAT(error.what(),
                        HasSubstr(std::string(format) +
                                  ": expected a format with several event streams (aedat4, aedat3, "
                                  "hdf5, rosbag, mcap, db3) for the stream '/events', found "));
        }
    }
}

TEST(OpenRecording, OfADavisStatedAsSmallerTheUpperLeftPartIsRead) {
    const TestFolder folder;
    const auto on_at = [](unsigned x, unsigned y) {  // in the image; X is stored mirrored
        return big_endian((179 - y) << 22 | (239 - x) << 12 | 1U << 11, 4) + big_endian(7, 4);
    };
    const auto path =
        folder.write("a.aedat", "#!AER-DAT2.0\r\n# AEChip: DAVIS240C\r\n#End Of ASCII Header\r\n" +
                                    on_at(5, 3) + on_at(100, 3) + on_at(5, 50));
    OpenOptions options;
    options.width = 100;
    options.height = 50;
    EXPECT_EQ(read_everything(*open_recording(path, options)).events,
              (std::vector{Event{from_us(7), 5, 3, Polarity::on}}));
}

TEST(OpenRecording, RawWithoutAHeaderIsWhatItIsSaidToBe) {
    const TestFolder folder;
    const auto events = some_events(100);
    const std::string bytes = read_text(write_recording(folder.path("a"), "evt3", events));
    const std::string path = folder.write("b", bytes.substr(bytes.find("% end\n") + 6));
    EXPECT_THAT(refusal(path), HasSubstr("an unrecognised format"));
    EXPECT_THAT(refusal(path, {.format = "evt3"}), HasSubstr("--input-size state both"));
    OpenOptions stated{.format = "evt3"};
    stated.width = stated.height = 128;
    EXPECT_TRUE(read_everything(*open_recording(path, stated)).events == events);
}

TEST(OpenRecording, RawOfAFormatThatIsNotReadIsRefusedByItsName) {
    const TestFolder folder;
    const std::string words("\x00\x80\x01\x02", 4);
    const auto path =
        folder.write("a.raw", "% format HISTO3D;height=320;width=320\n% end\n" + words);
    EXPECT_THAT(refusal(path), HasSubstr("found a Prophesee RAW file of format HISTO3D"));
    EXPECT_THAT(refusal(path, {.format = "evt3"}), HasSubstr("found HISTO3D"));
    EXPECT_THAT(refusal(folder.write("b.raw", "% evt 1.0\n% geometry 304x240\n" + words)),
                HasSubstr("found a Prophesee RAW file of format 1.0"));
}

TEST(OpenRecording, WhatIsNoRecordingIsRefusedByName) {
    const TestFolder folder;
    EXPECT_THAT(refusal(folder.path("missing")), HasSubstr("missing: cannot open"));
    EXPECT_THAT(refusal(folder.write("empty.txt", "")), HasSubstr("the file is empty"));
    EXPECT_THAT(refusal(folder.path("")), HasSubstr("directory"));
    EXPECT_THAT(refusal(folder.write("x.aedat4", std::string(5000, '\x91'))),
                HasSubstr("an unrecognised format"));
    EXPECT_THAT(refusal(folder.write("zeros.raw", std::string(5000, '\0'))),
                HasSubstr("an unrecognised format"));
    EXPECT_THAT(refusal(folder.write("prose.txt", "It was a dark and stormy night.\n")),
                HasSubstr("an unrecognised format"));
    EXPECT_THAT(refusal(folder.write("chip.aedat", "#!AER-DAT2.0\r\n# AEChip: Other\r\n")),
                HasSubstr("AEChip"));
    EXPECT_THAT(
        refusal(folder.write("t.txt", "1 2 3 0\n"), {.format = "nonsense"}, ErrorKind::usage),
        HasSubstr("nonsense"));
    EXPECT_THAT(refusal(folder.write("t.txt", "1 2 3 0\n"), {.format = "aedat3"}),
                HasSubstr("#!AER-DAT3.1"));
    EXPECT_THAT(
        refusal(folder.write("t.txt", "1 2 3 0\n"), {.width = 5, .height = 0}, ErrorKind::usage),
        HasSubstr("WIDTHxHEIGHT"));
}

TEST(OpenRecording, TheSizeComesFromTheOptionTheLineOrTheEvents) {
    const TestFolder folder;
    const auto size_of = [](const Recording& r) {
        return std::array{r.info().width, r.info().height};
    };
    const std::string with_line = folder.write("a.txt", "240 180\n0.1 5 6 1\n");
    const std::string without = folder.write("b.txt", "0.1 5 6 1\n0.2 9 2 0\n0.3 60000 2 0\n");
    EXPECT_EQ(size_of(*open_recording(with_line)), (std::array{240, 180}));
    EXPECT_EQ(size_of(*open_recording(with_line, {.width = 346, .height = 260})),
              (std::array{346, 260}));
    // A coordinate no sensor has is damage and makes no sensor of 60001 px.
    const auto scanned = open_recording(without);
    EXPECT_EQ(size_of(*scanned), (std::array{128, 128}));
    EXPECT_THAT(scanned->remarks(), testing::ElementsAre(HasSubstr("taken for 128x128")));
    EXPECT_EQ(summarize(*scanned).damaged[DamageReason::out_of_range], 1U);
    EXPECT_THAT(refusal(folder.write("c.txt", "t x y p\n0.1 5000 0 1\n")),
                HasSubstr("--input-size"));
}

/// DAT without a size: events of a DAVIS240, and some that no sensor has.
std::string dat_without_size(int events, int outliers) {
    std::string content("% Version 2\n\x0C\x08");
    const auto add = [&](int t, unsigned x, unsigned y) {
        content += little_endian(unsigned(t), 4) + little_endian(x | y << 14 | 1U << 28, 4);
    };
    for (int i = 0; i < events; ++i) add(10 * i, unsigned(i * 7 % 240), unsigned(i * 11 % 180));
    for (int i = 0; i < outliers; ++i) add(10 * events + i, 1541, 3082);
    return content;
}

TEST(OpenRecording, AFewDamagedCoordinatesDoNotDecideOnTheSize) {
    const TestFolder folder;
    const auto recording = open_recording(folder.write("a.dat", dat_without_size(4480, 2)));
    EXPECT_EQ(recording->info().width, 240);
    EXPECT_EQ(recording->info().height, 180);
    EXPECT_THAT(recording->remarks(), testing::ElementsAre(HasSubstr("but 2 of 4482")));
    const Summary sum = summarize(*recording);
    EXPECT_EQ(sum.events, 4480U);
    EXPECT_EQ(sum.damaged[DamageReason::out_of_range], 2U);
}

TEST(OpenRecording, NoEventLiesOutsideTheSizeThatIsStated) {
    const TestFolder folder;
    const auto events = some_events(500);
    for (const char* format :
         {"text", "aedat1", "aedat2", "aedat3", "aedat4", "evt2", "evt21", "evt3", "dat", "es"}) {
        SCOPED_TRACE(format);
        const std::string path = write_as(folder, format, events);
        const OpenOptions stated{.width = 50, .height = 40};
        const Batch batch = read_everything(*open_recording(path, stated));
        EXPECT_FALSE(batch.events.empty());
        EXPECT_TRUE(std::ranges::all_of(
            batch.events, [](const Event& event) { return event.x < 50 && event.y < 40; }));
        const Summary sum = summarize(*open_recording(path, stated));
        EXPECT_EQ(sum.events + sum.damaged[DamageReason::out_of_range], events.size());
    }
}

TEST(OpenRecording, ASensorLargerThanAnyKnownHasToBeStated) {
    const TestFolder folder;
    const std::string path = folder.write("a.dat", dat_without_size(300, 2));
    EXPECT_THAT(refusal(path), AllOf(HasSubstr("1542x3083"), HasSubstr("--input-size")));
    EXPECT_EQ(open_recording(path, {.width = 1542, .height = 3083})->info().width, 1542);
    // A header's word is taken as it is.
    const auto stated = open_recording(folder.write("b.txt", "1542 3083\n0.1 1541 3082 1\n"));
    EXPECT_EQ(stated->info().height, 3083);
    EXPECT_TRUE(stated->remarks().empty());
}

TEST(OpenRecording, FilesOfOtherKindsAreCalledByTheirName) {
    const TestFolder folder;
    EXPECT_THAT(refusal(folder.write("a.txt.gz", "\x1F\x8B\x08 rest")), HasSubstr("zcat"));
    EXPECT_THAT(refusal(folder.write("a.png", "\x89PNG\r\n")), HasSubstr("an image"));
    // It looks like an AEDAT 1 file: a line with '#', then bytes.
    const std::string bag = "#ROSBAG V2.0\n" + std::string(200, '\1');
    EXPECT_THAT(refusal(folder.write("a.bag", bag)),
                AllOf(HasSubstr("dvs_msgs/EventArray"), HasSubstr("and damage")));
    EXPECT_THAT(refusal(folder.write("a.mp4", std::string("\0\0\0\x1C", 4) + "ftypisom")),
                HasSubstr("a video"));
}

TEST(OpenRecording, ChunksAreOfBoundedSize) {
    const TestFolder folder;
    const auto recording =
        open_recording(write_recording(folder.path("a.txt"), "text", some_events(50'000)));
    RawPacket packet;
    std::uint64_t bytes = 0;
    while (recording->read(packet) == ReadStatus::data) {
        EXPECT_LE(packet.bytes.size(), FileRecording::kChunkBytes);
        bytes += packet.bytes.size();
        EXPECT_EQ(recording->position_bytes() - 8, bytes);  // behind "128 128\n"
    }
    EXPECT_EQ(recording->position_bytes(), recording->size_bytes());
}

TEST(OpenRecording, FormatsAreKnownByNameAndWritersByExtension) {
    for (const Format& format : all_formats()) EXPECT_EQ(find_format(format.name), &format);
    EXPECT_EQ(find_format("nonsense"), nullptr);
    EXPECT_EQ(format_for_writing("a/b.txt")->name, "text");
    EXPECT_EQ(format_for_writing("B.H5")->name, "hdf5");
    EXPECT_EQ(format_for_writing("b.aedat")->name, "aedat3");
    EXPECT_EQ(format_for_writing("b.xyz"), nullptr);
    EXPECT_THROW(open_writer("aedat2"), Error);
    EXPECT_THROW(open_writer("nonsense"), Error);
}

}  // namespace
}  // namespace eventide
