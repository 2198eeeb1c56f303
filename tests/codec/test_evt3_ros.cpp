// EVT3 as cameras sent it into ROS recordings: headerless words, cut into messages.
#include "src/codec/prophesee/evt3.h"
#include "src/core/byte_order.h"
#include "tests/codec/data_files.h"
#include "tests/codec/parser_checks.h"

#if EVENTIDE_SQLITE
#include <sqlite3.h>
#endif

#include <cstring>
#include <string>

namespace eventide {
namespace {

using Payloads = std::vector<Bytes>;

struct Sums {
    std::uint64_t events = 0, on = 0, t_us = 0, x = 0, y = 0;
};

Sums sums_of(const std::vector<Event>& events) {
    Sums sums;
    for (const Event& event : events) {
        ++sums.events;
        sums.on += event.polarity == Polarity::on;
        sums.t_us += std::uint64_t(to_us(event.t));
        sums.x += event.x;
        sums.y += event.y;
    }
    return sums;
}

Parsed parse(const Payloads& payloads, int width, int height) {
    Evt3Parser parser(width, height);
    Parsed parsed;
    for (const Bytes& payload : payloads) parser.parse(payload, parsed.data);
    parser.finish(parsed.data);
    parsed.damage = parser.damaged();
    return parsed;
}

/// The payloads of event_camera_msgs/EventPacket in an uncompressed ROS 1 bag: the encoding's name,
/// a byte for the order, a length, the words.
Payloads payloads_of_bag(const Bytes& bag) {
    const std::string_view text(reinterpret_cast<const char*>(bag.data()), bag.size());
    const std::string_view mark("\4\0\0\0evt3\0", 9);
    Payloads payloads;
    for (std::size_t at = text.find(mark); at != std::string_view::npos;
         at = text.find(mark, at + 1)) {
        const std::size_t begin = at + mark.size() + 4;
        if (begin > bag.size()) break;
        const std::size_t n = load_little<std::uint32_t>(bag.data() + begin - 4);
        if (n > bag.size() - begin) break;
        payloads.emplace_back(bag.begin() + std::ptrdiff_t(begin),
                              bag.begin() + std::ptrdiff_t(begin + n));
    }
    return payloads;
}

TEST(Evt3Ros, ARos1BagGivesItsNumbers) {
    const Bytes bag = read_data_file("ros1_events.bag");
    if (bag.empty()) GTEST_SKIP() << "no shared/data/formats";
    const Parsed parsed = parse(payloads_of_bag(bag), 640, 480);
    const Sums sums = sums_of(parsed.data.events);
    EXPECT_EQ(sums.events - sums.on, 218291U);
    EXPECT_EQ(sums.on, 125183U);
    ASSERT_FALSE(parsed.data.triggers.empty());
    EXPECT_EQ(to_us(parsed.data.triggers.front().t), 7139840);  // before the first event
    EXPECT_EQ(parsed.damage.total(), 0U);
}

#if EVENTIDE_SQLITE
/// The last field of each message is the payload; what stands before it has the same length in all.
Payloads payloads_of_db3(const std::string& path) {
    Payloads payloads;
    sqlite3* file = nullptr;
    sqlite3_stmt* rows = nullptr;
    const std::string uri = "file:" + path + "?mode=ro&immutable=1";
    constexpr int kReadOnly = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
    if (sqlite3_open_v2(uri.c_str(), &file, kReadOnly, nullptr) == SQLITE_OK)
        sqlite3_prepare_v2(file, "select data from messages order by timestamp", -1, &rows,
                           nullptr);
    while (rows && sqlite3_step(rows) == SQLITE_ROW) {
        const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(rows, 0));
        const auto n = std::size_t(sqlite3_column_bytes(rows, 0));
        const std::string_view text(reinterpret_cast<const char*>(data), n);
        const std::size_t at = text.find(std::string_view("evt3\0", 5));
        if (at == std::string_view::npos) continue;
        // CDR counts its alignment from behind its own four bytes.
        const std::size_t length_at = 4 + (at + 5 + 1 - 4 + 3) / 4 * 4;
        const std::size_t length = load_little<std::uint32_t>(data + length_at);
        EXPECT_LE(length, n - length_at - 4);
        payloads.emplace_back(data + length_at + 4, data + length_at + 4 + length);
    }
    sqlite3_finalize(rows);
    sqlite3_close(file);
    return payloads;
}

TEST(Evt3Ros, ARos2RecordingGivesItsSums) {
    const std::string path = EVENTIDE_SOURCE_DIR "/../shared/data/formats/ros2_evt3_trigger.db3";
    const Payloads payloads = payloads_of_db3(path);
    if (payloads.empty()) GTEST_SKIP() << "no shared/data/formats";
    EXPECT_EQ(payloads.size(), 105U);
    const Parsed parsed = parse(payloads, 1280, 720);
    const Sums sums = sums_of(parsed.data.events);
    EXPECT_EQ(sums.t_us, 1222326831810000U / 1000);
    EXPECT_EQ(sums.x, 42078718U);
    EXPECT_EQ(sums.y, 31656267U);
    EXPECT_EQ(sums.on, 41439U);
    ASSERT_EQ(parsed.data.triggers.size(), 2U);
    EXPECT_EQ(to_us(parsed.data.triggers[0].t) + to_us(parsed.data.triggers[1].t),
              29096982000 / 1000);
    EXPECT_EQ(parsed.data.triggers[0].kind, Trigger::Kind::falling);
    EXPECT_EQ(parsed.data.triggers[1].kind, Trigger::Kind::rising);
    EXPECT_EQ(parsed.damage.total(), 0U);
}
#endif

}  // namespace
}  // namespace eventide
