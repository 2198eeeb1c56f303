// An event sensor in software and the camera that reads it.
#pragma once

#include "drivers/v4l2/v4l2_camera.h"
#include "src/core/error.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <linux/videodev2.h>

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace eventide::testing_support::v4l2 {

constexpr std::uint32_t kEvt2 = v4l2_fourcc('P', 'S', 'E', 'E'),
                        kEvt21Swapped = v4l2_fourcc('P', 'S', 'E', '1'),
                        kEvt21 = v4l2_fourcc('P', 'S', 'E', '2'),
                        kEvt3 = v4l2_fourcc('P', 'S', 'E', '3');

inline std::vector<std::byte> bytes_of(std::initializer_list<unsigned> words) {
    std::vector<std::byte> bytes;
    for (const unsigned w : words) {
        bytes.push_back(std::byte(w & 0xFF));
        bytes.push_back(std::byte(w >> 8));
    }
    return bytes;
}
// EVT3 (docs/protocols.md D.4).
constexpr unsigned time_high(unsigned t) {
    return 0x8000 | t;
}
constexpr unsigned time_low(unsigned t) {
    return 0x6000 | t;
}
constexpr unsigned row(unsigned y) {
    return y;
}
constexpr unsigned column(unsigned x) {
    return 0x2800 | x;
}
constexpr unsigned kEndOfData = 0xE019;

inline V4l2NodeSettings sensor(std::uint32_t fourcc = kEvt3) {
    V4l2NodeSettings settings;
    settings.fourcc = fourcc;
    settings.width = 320;
    settings.height = 320;
    return settings;
}

inline V4l2Camera open(V4l2Settings settings = {}, bool reconnect = false,
                       std::function<void(const std::string&)> warn = {}) {
    return V4l2Camera{"/dev/video0", std::move(settings), reconnect, std::move(warn)};
}

inline std::string failure_of(const std::function<void()>& what) {
    try {
        what();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}

/// Until everything given was taken.
inline Batch read_all(V4l2Camera& camera, const V4l2Testbed& bed) {
    const auto parser = camera.make_parser();
    Batch data;
    for (RawPacket packet;;) {
        const ReadStatus status = camera.read(packet);
        if (status == ReadStatus::data) parser->parse(packet.bytes, data);
        if (status == ReadStatus::end || (status == ReadStatus::timeout && bed.all_taken())) break;
    }
    parser->finish(data);  // a first time waits for the next
    return data;
}

}  // namespace eventide::testing_support::v4l2
