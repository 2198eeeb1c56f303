// Packet headers of AEDAT 3, and how to tell one from other bytes.
#include "src/codec/aedat/aedat3_packet.h"

#include "src/core/byte_order.h"

namespace eventide {

Aedat3Packet read_aedat3_packet(const std::byte* p) {
    return {std::int16_t(load_little<std::uint16_t>(p)),
            std::int16_t(load_little<std::uint16_t>(p + 2)),
            load_little<std::uint32_t>(p + 4),
            load_little<std::uint32_t>(p + 8),
            load_little<std::uint32_t>(p + 12),
            load_little<std::uint32_t>(p + 16),
            load_little<std::uint32_t>(p + 20),
            load_little<std::uint32_t>(p + 24)};
}

bool is_plausible(const Aedat3Packet& packet) {
    constexpr std::uint32_t kMaxRecords = 1U << 26;
    // 2^22 times 36 minutes are 285 years: times since 1970 need a fifth of that.
    constexpr std::uint32_t kMaxOverflow = 1U << 22;
    if (packet.type < 0 || packet.type > Aedat3Packet::kLastType || packet.source < 0) return false;
    if (packet.overflow > kMaxOverflow || packet.capacity > kMaxRecords) return false;
    if (packet.number > packet.capacity || packet.valid > packet.number) return false;
    constexpr std::uint32_t kTimeOffset = 4;  // behind the word with the valid bit
    const auto is_record_of = [&](std::uint32_t bytes) {
        return packet.record_bytes == bytes && packet.time_offset == kTimeOffset;
    };
    switch (Aedat3Type(packet.type)) {
        case Aedat3Type::special:
            return is_record_of(Aedat3Packet::kSpecialBytes);
        case Aedat3Type::polarity:
            return is_record_of(Aedat3Packet::kPolarityBytes);
        case Aedat3Type::imu6:
            return is_record_of(Aedat3Packet::kImu6Bytes);
        case Aedat3Type::imu9:
            return is_record_of(Aedat3Packet::kImu9Bytes);
        case Aedat3Type::frame:  // any of its four stamps, though the end of the frame is usual
            return packet.record_bytes >= Aedat3Packet::kFrameHeaderBytes &&
                   packet.record_bytes <= Aedat3Packet::kMaxFrameBytes &&
                   packet.time_offset % 4 == 0 && packet.time_offset >= 4 &&
                   packet.time_offset <= 16;
    }
    return packet.record_bytes >= 8 && packet.record_bytes <= 1024 && packet.time_offset >= 4 &&
           packet.time_offset <= packet.record_bytes - 4;
}

}  // namespace eventide
