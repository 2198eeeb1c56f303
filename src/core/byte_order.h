// Numbers out of bytes and into them, whatever the machine's own order.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace eventide {

template <typename T>
constexpr T reverse_bytes(T value) {
    static_assert(std::is_unsigned_v<T>);
    T reversed = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
        reversed = T(reversed << 8) | T((value >> (8 * i)) & 0xFF);
    return reversed;
}

/// sizeof(T) bytes must be readable at p.
template <std::endian order, typename T>
T load(const std::byte* p) {
    T value;
    std::memcpy(&value, p, sizeof value);
    if constexpr (std::endian::native != order) value = reverse_bytes(value);
    return value;
}

template <typename T>
T load_little(const std::byte* p) {
    return load<std::endian::little, T>(p);
}

template <typename T>
T load_big(const std::byte* p) {
    return load<std::endian::big, T>(p);
}

inline float load_little_float(const std::byte* p) {
    return std::bit_cast<float>(load_little<std::uint32_t>(p));
}

template <typename T>
std::array<std::byte, sizeof(T)> little_bytes(T value) {
    static_assert(std::is_integral_v<T>);
    std::array<std::byte, sizeof(T)> bytes;
    for (std::size_t i = 0; i < sizeof(T); ++i)
        bytes[i] = std::byte((std::make_unsigned_t<T>(value) >> (8 * i)) & 0xFF);
    return bytes;
}

template <typename T>
void append_little(std::vector<std::byte>& out, T value) {
    for (const std::byte b : little_bytes(value)) out.push_back(b);
}

inline void append_little_float(std::vector<std::byte>& out, float value) {
    append_little(out, std::bit_cast<std::uint32_t>(value));
}

}  // namespace eventide
