// AEDAT 1.0, and what tells that a file is one.
#include "tests/codec/aedat2_words.h"

namespace eventide::aedat2 {
namespace {

Bytes aedat1_record(std::uint32_t address, std::int64_t t) {
    return join({big_endian(address, 2), big_endian(std::uint32_t(t), 4)});
}

TEST(Aedat1, SixByteRecordsOfADvs128) {
    const MakeParser make = [] { return std::make_unique<Aedat1Parser>(); };
    Bytes bytes;
    for (const Event& e : random_events(9, 60, 128, 128, 1000)) {
        const Bytes word =
            aedat1_record(std::uint32_t(127 - e.y) << 8 | std::uint32_t(127 - e.x) << 1 |
                              std::uint32_t(e.polarity == Polarity::off),
                          to_us(e.t));
        bytes.insert(bytes.end(), word.begin(), word.end());
    }
    const Parsed parsed = parse_whole(make, bytes);
    EXPECT_TRUE(parsed.data.events == random_events(9, 60, 128, 128, 1000));
    EXPECT_EQ(parsed.damage.total(), 0U);
    expect_same_for_any_split(make, bytes);
    expect_beginnings_for_any_cut(make, bytes);
    expect_bears_damage(make, bytes, 128, 128);
}

TEST(Aedat1, OfFilesThatWereJoinedTheHeadersAreNoRecords) {
    const MakeParser make = [] { return std::make_unique<Aedat1Parser>(); };
    const Bytes bytes = join({aedat1_record(2, 5000), to_bytes("#!AER-DAT1.0\r\n# a line\r\n"),
                              aedat1_record(2, 100), aedat1_record(2, 130)});
    const Parsed parsed = parse_whole(make, bytes);
    ASSERT_EQ(parsed.data.events.size(), 3U);
    EXPECT_EQ(parsed.data.events[1].t, from_us(5000));
    EXPECT_EQ(parsed.data.events[2].t, from_us(5030));
    EXPECT_EQ(parsed.data.triggers.size(), 1U);
    EXPECT_EQ(parsed.damage.total(), 0U);
    expect_same_for_any_split(make, bytes);
}

TEST(Aedat1, AfterAJumpTimeMayBeEarlier) {
    Aedat1Parser parser;
    Batch batch;
    parser.parse(aedat1_record(2, 5000), batch);
    parser.resync();
    parser.parse(aedat1_record(2, 100), batch);
    EXPECT_EQ(batch.events.size(), 2U);
    EXPECT_EQ(parser.damaged().total(), 0U);
}

TEST(Aedat1, IsRecognisedWithAndWithoutItsVersion) {
    const Bytes data = aedat1_record(0x0102, 5);
    for (const char* head : {"#!AER-DAT1.0\r\n", "# This is a raw AE data file\r\n"}) {
        Bytes bytes = to_bytes(head);
        bytes.insert(bytes.end(), data.begin(), data.end());
        EXPECT_TRUE(looks_like_aedat1(bytes)) << head;
    }
    EXPECT_FALSE(looks_like_aedat1(to_bytes("# a comment\n0.1 2 3 0\n")));
    EXPECT_FALSE(looks_like_aedat1(to_bytes("#!AER-DAT2.0\r\n")));
    EXPECT_FALSE(looks_like_aedat1(data));
}

}  // namespace
}  // namespace eventide::aedat2
