// The 28 bytes before each block of records of AEDAT 3 (docs/protocols.md D.2).
#pragma once

#include <cstddef>
#include <cstdint>

namespace eventide {

enum class Aedat3Type : std::int16_t { special = 0, polarity = 1, frame = 2, imu6 = 3, imu9 = 4 };

struct Aedat3Packet {
    static constexpr std::size_t kHeaderBytes = 28;
    static constexpr std::uint32_t kPolarityBytes = 8, kSpecialBytes = 8, kImu6Bytes = 36,
                                   kImu9Bytes = 48, kFrameHeaderBytes = 36;
    /// A frame of 2048 x 2048 px in four channels; longer records are held for damage.
    static constexpr std::uint32_t kMaxFrameBytes = kFrameHeaderBytes + 2048 * 2048 * 4 * 2;
    /// Types 5 and above of the format (samples, ear, configuration, points, ...) are passed over.
    static constexpr std::int16_t kLastType = 15;

    std::int16_t type = 0, source = 0;
    std::uint32_t record_bytes = 0;
    std::uint32_t time_offset = 0;  ///< of the record's main stamp
    std::uint32_t overflow = 0;     ///< t = overflow * 2^31 + stamp
    std::uint32_t capacity = 0, number = 0, valid = 0;
};

/// kHeaderBytes must be readable at p.
Aedat3Packet read_aedat3_packet(const std::byte* p);

/// True when the fields do not contradict each other or the format.
bool is_plausible(const Aedat3Packet& packet);

}  // namespace eventide
