// Event packets of ROS drivers: streams in words, splits, damage, and a driver's recording.
#include "src/codec/event_packet.h"
#include "src/core/byte_order.h"
#include "tests/codec/data_files.h"
#include "tests/codec/parser_checks.h"

#include <gmock/gmock.h>

#if EVENTIDE_SQLITE
#include <sqlite3.h>
#endif

#include <cstring>
#include <string>

namespace eventide {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kWidth = 640, kHeight = 480;
constexpr std::int64_t kStamp = 1'700'000'000'000'000'000;  // ns
constexpr std::int64_t kStampUs = kStamp / 1000;

using Words = std::vector<std::uint16_t>;

Bytes bytes_of(const Words& words) {
    Bytes bytes;
    for (const std::uint16_t word : words) append_little(bytes, word);
    return bytes;
}

Bytes packet(const EventPacketHeader& header, const Bytes& payload) {
    Bytes bytes;
    append_event_packet(header, payload, bytes);
    return bytes;
}

Bytes operator+(Bytes a, const Bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

Event at(std::int64_t us, int x, int y, bool on) {
    return {from_us(us), std::uint16_t(x), std::uint16_t(y), Polarity(on)};
}

MakeParser parser_of(EventPacketEncoding encoding) {
    return [encoding] { return std::make_unique<EventPacketParser>(encoding, kWidth, kHeight); };
}

// libcaer_cmp
std::uint16_t high(unsigned n) {
    return std::uint16_t(0x0000 | n);
}
std::uint16_t low(unsigned us) {
    return std::uint16_t(0x1000 | us);
}
std::uint16_t column(unsigned x) {
    return std::uint16_t(0x2000 | x);
}
std::uint16_t row(unsigned y, bool on) {
    return std::uint16_t(0x3000 | y | (on ? 0x800 : 0));
}
std::uint16_t base(unsigned y, bool on) {
    return std::uint16_t(0x4000 | y | (on ? 0x800 : 0));
}
std::uint16_t mask(unsigned bits) {
    return std::uint16_t(0x5000 | bits);
}

Parsed parse_compressed(const Words& words) {
    return parse_whole(parser_of(EventPacketEncoding::libcaer_cmp),
                       packet({kStamp, 0}, bytes_of(words)));
}

TEST(EventPacket, CompressedColumnsAreEvents) {
    const Parsed parsed =
        parse_compressed({column(5), row(7, true), low(3), row(8, false), high(1), low(2),
                          column(6), base(16, true), mask(0b10000001), mask(0b1)});
    EXPECT_THAT(parsed.data.events,
                ElementsAre(at(kStampUs, 5, 7, true), at(kStampUs + 3, 5, 8, false),
                            at(kStampUs + 4098, 6, 16, true), at(kStampUs + 4098, 6, 23, true),
                            at(kStampUs + 4098, 6, 24, true)));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(EventPacket, TimesOfACompressedPacketGoOnThoughItsHighBitsAreMissingOrWrap) {
    // A driver that joins two packets does not say that the high bits changed between them.
    EXPECT_THAT(
        parse_compressed({column(1), low(4000), row(1, true), low(10), row(2, true)}).data.events,
        ElementsAre(at(kStampUs + 4000, 1, 1, true), at(kStampUs + 4106, 1, 2, true)));
    // It has four of the high bits.
    EXPECT_THAT(
        parse_compressed(
            {column(1), high(15), row(1, true), high(0), row(2, true), high(1), row(3, true)})
            .data.events,
        ElementsAre(at(kStampUs + 15 * 4096, 1, 1, true), at(kStampUs + 16 * 4096, 1, 2, true),
                    at(kStampUs + 17 * 4096, 1, 3, true)));
    // All twelve are understood, too.
    EXPECT_THAT(
        parse_compressed({column(1), high(4095), row(1, true), high(0), row(2, true)}).data.events,
        ElementsAre(at(kStampUs + 4095 * 4096, 1, 1, true),
                    at(kStampUs + 4096 * 4096, 1, 2, true)));
}

TEST(EventPacket, CompressedWordsWithoutAPlaceAreDamage) {
    const Parsed parsed =
        parse_compressed({row(1, true), mask(1), column(3), mask(1), 0x6000, row(479, true),
                          row(480, true), column(640), row(1, true)});
    EXPECT_THAT(parsed.data.events, ElementsAre(at(kStampUs, 3, 479, true)));
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 2U);
    EXPECT_EQ(parsed.damage[DamageReason::unknown_word], 4U);
}

Bytes libcaer_event(unsigned x, unsigned y, bool on, std::int32_t us, bool valid = true) {
    Bytes bytes;
    append_little(bytes, std::uint32_t(x << 17 | y << 2 | unsigned(on) << 1 | unsigned(valid)));
    append_little(bytes, us);
    return bytes;
}

TEST(EventPacket, LibcaersEventsWrapAfter31Bits) {
    const Bytes payload = libcaer_event(1, 2, true, 0x7FFFFFFF) +
                          libcaer_event(9, 9, true, 0x7FFFFFFF, false) +
                          libcaer_event(3, 4, false, 1) + libcaer_event(3, 4, false, -5);
    const Parsed parsed =
        parse_whole(parser_of(EventPacketEncoding::libcaer), packet({kStamp, 0}, payload));
    EXPECT_THAT(parsed.data.events, ElementsAre(at(kStampUs + 0x7FFFFFFF, 1, 2, true),
                                                at(kStampUs + 0x80000001LL, 3, 4, false)));
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U) << "a negative time";
    EXPECT_EQ(parsed.damage.total(), 1U) << "what a filter took out is none";
}

Bytes mono_event(unsigned x, unsigned y, bool on, std::uint32_t ns) {
    Bytes bytes;
    append_little(bytes,
                  ns | std::uint64_t{x} << 32 | std::uint64_t{y} << 48 | std::uint64_t{on} << 63);
    return bytes;
}

TEST(EventPacket, MonoIsShiftedToItsFirstStampAndStaysThere) {
    const Bytes stream =
        packet({5'000'000, kStamp}, mono_event(1, 2, true, 0) + mono_event(3, 4, false, 7'900)) +
        packet({6'000'000, kStamp + 3'000'000},
               mono_event(5, 6, true, 0));  // its stamp is 2 ms late
    const Parsed parsed = parse_whole(parser_of(EventPacketEncoding::mono), stream);
    EXPECT_THAT(parsed.data.events,
                ElementsAre(at(kStampUs, 1, 2, true), at(kStampUs + 7, 3, 4, false),
                            at(kStampUs + 1000, 5, 6, true)));
}

// EVT3
std::uint16_t evt_high(unsigned n) {
    return std::uint16_t(0x8000 | n);
}
std::uint16_t evt_low(unsigned us) {
    return std::uint16_t(0x6000 | us);
}
std::uint16_t evt_row(unsigned y) {
    return std::uint16_t(y);
}
std::uint16_t evt_x(unsigned x, bool on) {
    return std::uint16_t(0x2000 | x | (on ? 0x800 : 0));
}

TEST(EventPacket, Evt3IsShiftedToItsStamp) {
    const Bytes stream =
        packet({0, kStamp}, bytes_of({evt_high(2), evt_low(5), evt_row(7), evt_x(8, true)})) +
        packet({0, kStamp + 9'000},
               bytes_of({evt_low(15), evt_x(9, false)}));  // goes on with row and high time
    const Parsed parsed = parse_whole(parser_of(EventPacketEncoding::evt3), stream);
    EXPECT_THAT(parsed.data.events,
                ElementsAre(at(kStampUs, 8, 7, true), at(kStampUs + 10, 9, 7, false)));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(EventPacket, AfterAGapTimeGoesOnAndOnlyADriverThatBeganAnewSetsIt) {
    const auto stream = [](std::int64_t stamp_us, unsigned high_word) {
        return packet({0, stamp_us * 1000},
                      bytes_of({evt_high(high_word), evt_low(0), evt_row(1), evt_x(1, true)}));
    };
    EventPacketParser parser(EventPacketEncoding::evt3, kWidth, kHeight);
    Batch batch;
    parser.parse(stream(kStampUs, 0), batch);
    parser.resync();
    parser.parse(stream(kStampUs + 8192 + 3000, 2),
                 batch);  // the stamp is late; the sensor knows better
    EXPECT_EQ(batch.events.back().t, from_us(kStampUs + 8192));
    parser.resync();
    parser.parse(stream(kStampUs + 60'000'000, 3), batch);  // the sensor's clock has wrapped unseen
    EXPECT_EQ(batch.events.back().t, from_us(kStampUs + 60'000'000));
    EXPECT_THAT(batch.triggers, IsEmpty());
    parser.resync();
    parser.parse(stream(kStampUs + 10'000'000, 4), batch);  // the driver's clock was set back
    EXPECT_EQ(batch.events.back().t, from_us(kStampUs + 10'000'000));
    ASSERT_EQ(batch.triggers.size(), 1U);
    EXPECT_EQ(batch.triggers[0].kind, Trigger::Kind::timestamp_reset);
    EXPECT_EQ(parser.damaged().total(), 0U);
}

TEST(EventPacket, OfAnEvt3PacketThatIsCutByAGapNothingComesWithTheNext) {
    const auto stream = [](unsigned high_word) {
        return packet({0, kStamp}, bytes_of({evt_high(high_word), evt_low(0), evt_row(1),
                                             evt_x(1, true), evt_x(2, true)}));
    };
    const Bytes cut = stream(9);
    EventPacketParser parser(EventPacketEncoding::evt3, kWidth, kHeight);
    Batch batch;
    parser.parse(std::span(cut).first(cut.size() - 2), batch);
    parser.resync();
    parser.parse(stream(1), batch);
    EXPECT_THAT(batch.events, ElementsAre(at(kStampUs, 1, 1, true), at(kStampUs, 2, 1, true)));
}

/// Random packets of each encoding.
Bytes random_stream(EventPacketEncoding encoding, unsigned seed) {
    std::mt19937 random(seed);
    const auto pick = [&](unsigned n) { return unsigned(random() % n); };
    Bytes stream;
    for (unsigned k = 0; k < 20; ++k) {
        const EventPacketHeader header{std::uint64_t(kStamp) + 100'000'000ULL * k,
                                       kStamp + 100'000'000LL * k};
        Bytes payload;
        std::uint32_t t = 0;
        for (unsigned i = pick(40); i > 0; --i) {
            t += pick(50);
            switch (encoding) {
                case EventPacketEncoding::evt3:
                    payload = payload +
                              bytes_of({evt_high(24 * k + t / 4096), evt_low(t % 4096),
                                        evt_row(pick(kHeight)), evt_x(pick(kWidth), pick(2) == 1)});
                    break;
                case EventPacketEncoding::libcaer:
                    payload = payload + libcaer_event(pick(kWidth), pick(kHeight), pick(2) == 1,
                                                      std::int32_t(t));
                    break;
                case EventPacketEncoding::libcaer_cmp:
                    payload = payload + bytes_of({low(t % 4096), column(pick(kWidth)),
                                                  base(pick(kHeight - 8), true), mask(pick(256))});
                    break;
                case EventPacketEncoding::mono:
                    payload =
                        payload + mono_event(pick(kWidth), pick(kHeight), pick(2) == 1, t * 1000);
                    break;
            }
        }
        stream = stream + packet(header, payload);
    }
    return stream;
}

class AnyEventPacket : public testing::TestWithParam<EventPacketEncoding> {};

TEST_P(AnyEventPacket, GivesTheSameForAnySplit) {
    const Bytes stream = random_stream(GetParam(), 1);
    const Parsed parsed = parse_whole(parser_of(GetParam()), stream);
    EXPECT_GT(parsed.data.events.size(), 200U);
    EXPECT_EQ(parsed.damage.total(), 0U);
    expect_orderly(parsed, kWidth, kHeight);
    expect_same_for_any_split(parser_of(GetParam()), stream);
}

TEST_P(AnyEventPacket, BearsDamage) {
    expect_bears_damage(parser_of(GetParam()), random_stream(GetParam(), 2), kWidth, kHeight);
}

TEST_P(AnyEventPacket, CountsAnEndInTheMiddle) {
    Bytes stream =
        random_stream(GetParam(), 3) + packet({std::uint64_t(2 * kStamp), 2 * kStamp}, Bytes(16));
    stream.pop_back();
    EXPECT_GE(parse_whole(parser_of(GetParam()), stream).damage[DamageReason::truncated], 1U);
}

INSTANTIATE_TEST_SUITE_P(, AnyEventPacket,
                         testing::Values(EventPacketEncoding::evt3, EventPacketEncoding::libcaer,
                                         EventPacketEncoding::libcaer_cmp,
                                         EventPacketEncoding::mono));

#if EVENTIDE_SQLITE
/// Reads CDR, little endian, behind its four bytes of encapsulation.
class CdrReader {
public:
    explicit CdrReader(std::span<const std::byte> bytes) : bytes_(bytes.subspan(4)) {}
    template <typename T>
    T number() {
        at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
        const T value = load_little<T>(bytes_.subspan(at_, sizeof(T)).data());
        at_ += sizeof(T);
        return value;
    }
    std::span<const std::byte> octets() {
        const std::size_t n = number<std::uint32_t>();
        const auto octets = bytes_.subspan(at_, n);
        at_ += n;
        return octets;
    }

private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

/// The sums are those that the driver's author has in the tests of event_camera_codecs.
TEST(EventPacket, ADriversRecordingGivesItsSums) {
    const std::string path =
        EVENTIDE_SOURCE_DIR "/../shared/data/formats/ros2_libcaer_rollover.db3";
    sqlite3* file = nullptr;
    sqlite3_stmt* rows = nullptr;
    const std::string uri = "file:" + path + "?mode=ro&immutable=1";
    if (sqlite3_open_v2(uri.c_str(), &file, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr) ==
        SQLITE_OK)
        sqlite3_prepare_v2(file, "select data from messages order by timestamp", -1, &rows,
                           nullptr);
    if (rows == nullptr) {
        sqlite3_close(file);
        GTEST_SKIP() << "no shared/data/formats";
    }
    EventPacketParser parser(EventPacketEncoding::libcaer, kWidth, kHeight);
    Batch batch;
    std::uint64_t messages = 0, below_us = 0;
    for (; sqlite3_step(rows) == SQLITE_ROW; ++messages) {
        CdrReader message({static_cast<const std::byte*>(sqlite3_column_blob(rows, 0)),
                           std::size_t(sqlite3_column_bytes(rows, 0))});
        const auto sec = message.number<std::int32_t>();
        const auto nanosec = message.number<std::uint32_t>();
        message.octets();  // frame_id
        EXPECT_EQ(message.number<std::uint32_t>(), kHeight);
        EXPECT_EQ(message.number<std::uint32_t>(), kWidth);
        message.number<std::uint64_t>();  // seq
        const auto base_ns = message.number<std::uint64_t>();
        message.octets();  // encoding
        message.number<std::uint8_t>();
        below_us = base_ns % 1000;  // the same in all
        Bytes bytes;
        append_event_packet({base_ns, std::int64_t(sec) * 1'000'000'000 + nanosec},
                            message.octets(), bytes);
        parser.parse(bytes, batch);
    }
    sqlite3_finalize(rows);
    sqlite3_close(file);
    std::uint64_t t_ns = 0, x = 0, y = 0, on = 0;
    for (const Event& event : batch.events) {
        t_ns += std::uint64_t(to_us(event.t)) * 1000 + below_us;
        x += event.x;
        y += event.y;
        on += event.polarity == Polarity::on;
    }
    EXPECT_EQ(messages, 201U);
    EXPECT_EQ(t_ns, 15762826572202229126U) << "modulo 2^64";
    EXPECT_EQ(x, 111651612U);
    EXPECT_EQ(y, 82801007U);
    EXPECT_EQ(on, 181908U);
    EXPECT_EQ(parser.damaged().total(), 0U);
}
#endif

}  // namespace
}  // namespace eventide
