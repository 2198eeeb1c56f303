// What a message shows of a text that may be a whole file without a line's end.
#pragma once

#include <string>
#include <string_view>

namespace eventide {

inline std::string piece_of(std::string_view text) {
    constexpr std::size_t kMaxShown = 160;  // bytes
    if (text.size() <= kMaxShown) return std::string{text};
    return std::string{text.substr(0, kMaxShown)} + "...";
}

}  // namespace eventide
