// Events as words of cameras and files.
#include "apps/cli/stress/wire_words.h"

#include "src/codec/inivation/davis.h"
#include "src/codec/inivation/dvs128.h"
#include "src/codec/prophesee/dat.h"
#include "src/codec/prophesee/evt2.h"
#include "src/codec/prophesee/evt3.h"

namespace eventide::stress {
namespace {

using Events = std::span<const Event>;

/// Little endian.
template <typename Word>
void put(Word word, std::vector<std::byte>& out) {
    for (std::size_t i = 0; i < sizeof(Word); ++i)
        out.push_back(std::byte(std::uint64_t(word) >> (8 * i) & 0xff));
}

bool is_on(const Event& event) {
    return event.polarity == Polarity::on;
}

/// 15 bits of time, counted from the reset; the rows of a DAVIS346 lie along x.
std::vector<std::byte> davis_words(Events events) {
    std::vector<std::byte> out;
    put(std::uint16_t{1}, out);  // timestamp reset
    std::int64_t wraps = 0;
    for (const Event& e : events) {
        for (; wraps < to_us(e.t) >> 15; ++wraps) put(std::uint16_t(7U << 12 | 1U), out);
        put(std::uint16_t(8U << 12 | unsigned(to_us(e.t) & 0x7fff)), out);
        put(std::uint16_t(1U << 12 | e.x), out);
        put(std::uint16_t((is_on(e) ? 3U : 2U) << 12 | e.y), out);
    }
    return out;
}

/// 14 bits of time; the sensor is mirrored.
std::vector<std::byte> dvs128_words(Events events) {
    std::vector<std::byte> out;
    std::int64_t wraps = 0;
    for (const Event& e : events) {
        for (; wraps < to_us(e.t) >> 14; ++wraps) put(std::uint32_t{0x80000000}, out);
        put(std::uint32_t((is_on(e) ? 0U : 1U) | unsigned(127 - e.x) << 1 |
                          unsigned(127 - e.y) << 8 | unsigned(to_us(e.t) & 0x3fff) << 16),
            out);
    }
    return out;
}

/// 6 bits of time in each event, 28 in words of their own.
std::vector<std::byte> evt2_words(Events events) {
    std::vector<std::byte> out;
    std::int64_t high = -1;
    for (const Event& e : events) {
        if (to_us(e.t) >> 6 != high) {
            high = to_us(e.t) >> 6;
            put(std::uint32_t(8U << 28 | unsigned(high & 0xfffffff)), out);
        }
        put(std::uint32_t((is_on(e) ? 1U : 0U) << 28 | unsigned(to_us(e.t) & 63) << 22 |
                          unsigned(e.x) << 11 | e.y),
            out);
    }
    return out;
}

/// 12 bits of time in each of two words.
std::vector<std::byte> evt3_words(Events events) {
    std::vector<std::byte> out;
    std::int64_t high = -1;
    for (const Event& e : events) {
        for (std::int64_t now = to_us(e.t) >> 12; high != now; high = high < 0 ? now : high + 1)
            put(std::uint16_t(8U << 12 | unsigned((high < 0 ? now : high + 1) & 0xfff)), out);
        put(std::uint16_t(6U << 12 | unsigned(to_us(e.t) & 0xfff)), out);
        put(std::uint16_t(e.y), out);
        put(std::uint16_t(2U << 12 | (is_on(e) ? 1U << 11 : 0U) | e.x), out);
    }
    return out;
}

/// 32 bits of time.
std::vector<std::byte> dat_records(Events events) {
    std::vector<std::byte> out;
    for (const Event& e : events) {
        put(std::uint32_t(to_us(e.t)), out);
        put(std::uint32_t(unsigned(e.x) | unsigned(e.y) << 14 | (is_on(e) ? 1U << 28 : 0U)), out);
    }
    return out;
}

}  // namespace

std::vector<Wire> wires() {
    constexpr std::int64_t kBefore = 1'500'000;  // us
    return {{"DAVIS", 346, 260, 0, "32.8 ms", davis_words,
             [] { return std::make_unique<DavisParser>(DavisSensor{}); }},
            {"DVS128", 128, 128, 0, "16.4 ms", dvs128_words,
             [] { return std::make_unique<Dvs128Parser>(); }},
            {"EVT3", 64, 48, (std::int64_t{1} << 24) - kBefore, "16.8 s", evt3_words,
             [] { return std::make_unique<Evt3Parser>(64, 48); }},
            {"EVT2", 64, 48, (std::int64_t{1} << 34) - kBefore, "4.8 h", evt2_words,
             [] { return std::make_unique<Evt2Parser>(64, 48); }},
            {"DAT", 64, 48, (std::int64_t{1} << 32) - kBefore, "71.6 min", dat_records,
             [] { return std::make_unique<DatParser>(DatHeader::Record::events_v2, 64, 48); }}};
}

}  // namespace eventide::stress
