// ROS 1 bags as rosbag writes them: connections and messages in packed chunks, an index behind.
#pragma once

#include "src/core/byte_order.h"
#include "src/core/event.h"
#include "src/core/frame_data.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <cstddef>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace eventide::test {

using BagBytes = std::string;

template <typename T>
BagBytes little(T value) {
    std::vector<std::byte> bytes;
    append_little(bytes, value);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
inline BagBytes block(const BagBytes& bytes) {
    return little(std::uint32_t(bytes.size())) + bytes;
}
inline BagBytes ros_time(SensorTime t) {
    return little(std::uint32_t(to_us(t) / 1'000'000)) +
           little(std::uint32_t(to_us(t) % 1'000'000 * 1000));
}
inline BagBytes fields(const std::vector<std::pair<std::string, BagBytes>>& named) {
    BagBytes bytes;
    for (const auto& [name, value] : named) bytes += block(name + "=" + value);
    return bytes;
}
inline BagBytes record(char op, std::vector<std::pair<std::string, BagBytes>> named,
                       const BagBytes& data) {
    named.emplace_back("op", BagBytes(1, op));
    return block(fields(named)) + block(data);
}
inline BagBytes connection(std::uint32_t number, const std::string& type,
                           const std::string& topic = "/dvs/topic") {
    return record(7, {{"conn", little(number)}, {"topic", topic}},
                  fields({{"topic", topic}, {"type", type}, {"md5sum", "0"}}));
}
inline BagBytes message(std::uint32_t number, const BagBytes& data) {
    return record(2, {{"conn", little(number)}, {"time", little(std::uint64_t{0})}}, data);
}
inline BagBytes message_header(SensorTime t) {
    return little(std::uint32_t{7}) + ros_time(t) + block("dvs");
}

inline BagBytes event_array(int width, int height, std::span<const Event> events) {
    BagBytes bytes = message_header({}) + little(std::uint32_t(height)) +
                     little(std::uint32_t(width)) + little(std::uint32_t(events.size()));
    for (const Event& event : events)
        bytes += little(event.x) + little(event.y) + ros_time(event.t) +
                 BagBytes(1, event.polarity == Polarity::on ? '\1' : '\0');
    return bytes;
}
/// Rows are longer than the frame is wide, as they may be.
inline BagBytes image(const ReferenceImage& image, const std::string& encoding = "mono8") {
    const int width = image.pixels.width(), height = image.pixels.height();
    BagBytes rows;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) rows += char(image.pixels(y, x) / 257);
        rows += "pad";
    }
    return message_header(image.t) + little(std::uint32_t(height)) + little(std::uint32_t(width)) +
           block(encoding) + BagBytes(1, '\0') + little(std::uint32_t(width + 3)) + block(rows);
}

inline BagBytes packed(const std::string& packing, const BagBytes& bytes) {
    if (packing == "bz2") {
        auto size = unsigned(bytes.size() * 2 + 1000);
        BagBytes out(size, '\0');
        BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(bytes.data()),
                                 unsigned(bytes.size()), 9, 0, 0);
        out.resize(size);
        return out;
    }
    if (packing == "lz4") {
        BagBytes out(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
        out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
        return out;
    }
    return bytes;
}
inline BagBytes chunk(const std::string& packing, const BagBytes& bytes) {
    return record(5, {{"compression", packing}, {"size", little(std::uint32_t(bytes.size()))}},
                  packed(packing, bytes));
}
/// `content`: chunks. The bag's header before, an index record after them, then connections.
inline BagBytes bag(const BagBytes& content, const BagBytes& connections = {}) {
    return "#ROSBAG V2.0\n" +
           record(3, {{"conn_count", little(std::uint32_t{2})}}, BagBytes(100, ' ')) + content +
           record(4, {{"conn", little(std::uint32_t{0})}}, BagBytes(24, '\0')) + connections;
}

}  // namespace eventide::test
