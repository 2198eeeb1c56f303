// Parts of DDS's C structs, made of what is ours; nothing is copied.
#pragma once

#include <ros2_messages.h>

#include <cstdint>
#include <string>
#include <vector>

namespace eventide {

/// DDS's C structs hold pointers they do not write through.
inline char* borrowed(const std::string& text) {
    return const_cast<char*>(text.c_str());
}

template <typename Sequence, typename T>
void borrow(Sequence& sequence, const std::vector<T>& values) {
    sequence._length = sequence._maximum = std::uint32_t(values.size());
    sequence._buffer = const_cast<T*>(values.data());
    sequence._release = false;
}

/// `stamp_us` since 1970.
inline std_msgs_msg_dds__Header_ header_of(std::int64_t stamp_us, const std::string& frame_id) {
    constexpr std::int64_t kSecond = 1'000'000;
    const std::int64_t rest = ((stamp_us % kSecond) + kSecond) % kSecond;
    std_msgs_msg_dds__Header_ header{};
    header.stamp.sec = std::int32_t((stamp_us - rest) / kSecond);
    header.stamp.nanosec = std::uint32_t(rest * 1000);
    header.frame_id = borrowed(frame_id);
    return header;
}

}  // namespace eventide
