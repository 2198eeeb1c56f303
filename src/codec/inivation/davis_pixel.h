// From the two reads of a DAVIS's pixel to its intensity, for its USB words and for recordings of
// them (docs/protocols.md A.10).
#pragma once

#include <algorithm>
#include <cstdint>

namespace eventide {

/// What the converter gave, of 10 bits, in the range of all chips: a DAVIS240's uses half of it.
constexpr std::uint16_t davis_sample(std::uint16_t adc, bool is_davis240) {
    return is_davis240 ? std::uint16_t(adc * 2) : adc;
}

/// Reset minus signal (correlated double sampling), in 16 bits. A pixel that was bright already
/// while it was reset (libcaer's threshold), or that reached the end of the scale, would come out
/// dark: it is white.
constexpr std::uint16_t davis_intensity(std::uint16_t reset, std::uint16_t signal) {
    constexpr int kMax = 1023, kLowestGoodReset = 384;
    const bool overexposed = reset < kLowestGoodReset || signal == 0;
    const int value = overexposed ? kMax : std::clamp(int(reset) - int(signal), 0, kMax);
    // 10 bits fill 16 by repeating the highest, so that white is 65535.
    return std::uint16_t(value << 6 | value >> 4);
}

}  // namespace eventide
