// Times of 32 bits that wrap.
#pragma once

#include <cstdint>

namespace eventide {

/// us: the time nearest to `near_us` with these lower bits. A record out of order across a wrap so
/// lies before it, not a range behind it.
inline std::int64_t nearest_time(std::uint32_t stamp, std::int64_t near_us) {
    return near_us + std::int32_t(stamp - std::uint32_t(near_us));
}

}  // namespace eventide
