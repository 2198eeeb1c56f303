// Event packets of a ROS driver's recording.
#include "tests/codec/data_files.h"
#include "tests/codec/event_packets.h"

#include <sqlite3.h>

#include <string>

namespace eventide::event_packets {
namespace {

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

}  // namespace
}  // namespace eventide::event_packets
