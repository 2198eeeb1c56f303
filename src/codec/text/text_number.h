// Decimal numbers in text, exactly: no floating point between the digits and the microsecond.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

namespace eventide {

/// All that 64 bits hold.
inline constexpr std::array<std::uint64_t, 20> kPowersOfTen = [] {
    std::array<std::uint64_t, 20> powers{1};
    for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = powers[i - 1] * 10;
    return powers;
}();

/// digits * 10^exponent, with sign.
struct Decimal {
    std::uint64_t digits = 0;
    int exponent = 0;
    bool negative = false;
    bool fractional = false;  ///< written with a decimal point or an exponent
};

/// Reads all of `text` as "[+-]123[.456][e[+-]7]". Digits after the nineteenth significant one are
/// dropped, which no rounding to microseconds can notice.
std::optional<Decimal> parse_decimal(std::string_view text);

/// The value times 10^shift as an integer, rounded half away from zero; empty when it does not fit
/// 63 bits.
std::optional<std::int64_t> scaled_integer(const Decimal& value, int shift);

/// The digits at p, at most eight, in one go (SIMD within a register): the number of them, and
/// their value. Eight bytes from p must be readable. Little-endian machines.
struct DigitRun {
    std::uint32_t value;
    int length;
};
inline DigitRun read_digits(const char* p) {
    static_assert(std::endian::native == std::endian::little);
    std::uint64_t bytes;
    std::memcpy(&bytes, p, sizeof bytes);
    const std::uint64_t digits = bytes ^ 0x3030303030303030U;  // '0'..'9' become 0..9
    // Bit 7 of each byte that is no digit: above 9 (0x76 + 10 = 0x80), or above 127. The sum is of
    // the low seven bits, so that nothing is carried from byte to byte.
    const std::uint64_t others =
        (((digits & 0x7F7F7F7F7F7F7F7FU) + 0x7676767676767676U) | digits) & 0x8080808080808080U;
    const int length = std::countr_zero(others) / 8;
    if (length == 0) return {0, 0};
    // Leading zeros in front make eight digits of any number of them; pairs, fours, eights follow.
    std::uint64_t sum = digits << (64 - 8 * length);
    sum = (sum * 10 + (sum >> 8)) & 0x00FF00FF00FF00FFU;
    sum = (sum * 100 + (sum >> 16)) & 0x0000FFFF0000FFFFU;
    sum = (sum * 10000 + (sum >> 32)) & 0xFFFFFFFFU;
    return {std::uint32_t(sum), length};
}

}  // namespace eventide
