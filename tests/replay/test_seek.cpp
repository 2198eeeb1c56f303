// After a seek every event from the asked time on is read, without reading all before it.
#include "replay/seek.h"

#include "replay/formats.h"
#include "src/core/error.h"
#include "tests/replay/recording_files.h"

namespace eventide {
namespace {

constexpr std::size_t kEvents = 150'000;

std::string big_endian(std::uint32_t value) {
    std::string out;
    for (int shift = 24; shift >= 0; shift -= 8) out += char(value >> shift & 0xFF);
    return out;
}

/// AEDAT 2.0 has no writer: DVS128 words.
std::string write_aedat2(const TestFolder& folder, const std::vector<Event>& events) {
    std::string content = "#!AER-DAT2.0\r\n# AEChip: DVS128\r\n#End Of ASCII Header\r\n";
    for (const Event& e : events)
        content += big_endian(std::uint32_t(127 - e.y) << 8 | std::uint32_t(127 - e.x) << 1 |
                              std::uint32_t(e.polarity == Polarity::off)) +
                   big_endian(std::uint32_t(to_us(e.t)));
    return folder.write("a.aedat2", content);
}

/// Seeks one recording forth and back, and reads from there.
void expect_seeks(const std::string& path, const std::vector<Event>& events) {
    const auto recording = open_recording(path);
    const auto parser = recording->make_parser();
    for (const std::size_t i : {kEvents / 2, kEvents - 10, std::size_t(0), kEvents / 7}) {
        const SensorTime t = events[i].t;
        recording->seek(t);
        parser->resync();
        if (i > kEvents / 4) {
            EXPECT_GT(recording->position_bytes(), recording->size_bytes() / 4);
        }
        Batch batch;
        RawPacket packet;
        while (recording->read(packet) == ReadStatus::data) parser->parse(packet.bytes, batch);
        const auto first = std::find_if(batch.events.begin(), batch.events.end(),
                                        [&](const Event& e) { return e.t >= t; });
        const auto expected =
            std::find_if(events.begin(), events.end(), [&](const Event& e) { return e.t >= t; });
        EXPECT_EQ(batch.events.end() - first, events.end() - expected);
        EXPECT_TRUE(std::equal(first, batch.events.end(), expected)) << "from event " << i;
    }
    EXPECT_EQ(parser->damaged().total(), 0U);
}

TEST(Seek, EveryWritableFormatFindsItsTimes) {
    const TestFolder folder;
    const auto events = some_events(kEvents, 3'000'000);
    for (const char* format : {"text", "aedat3"}) {
        SCOPED_TRACE(format);
        expect_seeks(write_recording(folder.path("a"), format, events), events);
    }
}

TEST(Seek, Aedat2FindsItsTimes) {
    const TestFolder folder;
    const auto events = some_events(kEvents, 3'000'000);
    expect_seeks(write_aedat2(folder, events), events);
}

TEST(Seek, AClockThatWrappedIsReadFromTheBeginning) {
    const TestFolder folder;
    const auto events = some_events(kEvents, (std::int64_t(1) << 31) - 500'000);
    const auto recording = open_recording(write_aedat2(folder, events));
    const std::uint64_t begin = recording->position_bytes();
    recording->seek(events.back().t);
    EXPECT_EQ(recording->position_bytes(), begin);
}

TEST(Seek, ShortOrDamagedFilesAreSoughtSafely) {
    const TestFolder folder;
    const auto recording = open_recording(folder.write("a.txt", "9 9\n0.1 1 2 1\n0.2 1 2 1\n"));
    recording->seek(from_us(200'000));
    EXPECT_EQ(read_everything(*recording).events.size(), 2U);
    recording->seek(from_us(999'000'000));
    EXPECT_EQ(read_everything(*recording).events.size(), 2U);

    std::string content = "9 9\n0.1 1 2 1\n" + std::string(1 << 20, 'x');
    const auto junk = open_recording(folder.write("b.txt", content));
    junk->seek(from_us(200'000));
    EXPECT_EQ(read_everything(*junk).events.size(), 1U);
}

}  // namespace
}  // namespace eventide
