// Numbers and text: from text the one place, but for the exact decimals of text recordings
// (src/codec/text/text_number.h).
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace eventide {

/// "346x260"
inline std::string size_text(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

/// "1 image", "2 images"
inline std::string counted(std::uint64_t n, const std::string& what) {
    return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

/// The number that `text` begins with, which is taken off it; nothing, and `text` as it was, where
/// it begins with none. No white space and no '+' before it; floating point numbers are finite.
template <typename T>
requires std::integral<T> || std::floating_point<T> std::optional<T> take_number(
    std::string_view& text)
noexcept {
    T value{};
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{}) return std::nullopt;
    if constexpr (std::floating_point<T>)
        if (!std::isfinite(value)) return std::nullopt;
    text.remove_prefix(std::size_t(rest - text.data()));
    return value;
}

/// The whole of `text`, as above.
template <typename T>
std::optional<T> number_in(std::string_view text) noexcept {
    const std::optional<T> value = take_number<T>(text);
    return text.empty() ? value : std::nullopt;
}

/// The whole of `text` as hexadecimal digits, without "0x": an exact way to write floating point
/// numbers.
template <typename T>
std::optional<T> hex_number_in(std::string_view text) noexcept {
    T value{};
    const char* const end = text.data() + text.size();
    std::from_chars_result read{};
    if constexpr (std::floating_point<T>)
        read = std::from_chars(text.data(), end, value, std::chars_format::hex);
    else
        read = std::from_chars(text.data(), end, value, 16);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{value} : std::nullopt;
}

/// "640x480": width and height.
inline std::optional<std::pair<int, int>> size_in(std::string_view text) noexcept {
    const std::optional<int> width = take_number<int>(text);
    if (!width || !text.starts_with('x')) return std::nullopt;
    const std::optional<int> height = number_in<int>(text.substr(1));
    if (!height) return std::nullopt;
    return std::pair{*width, *height};
}

}  // namespace eventide
