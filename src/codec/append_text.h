// Text among the bytes of a file.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace eventide {

inline void append_text(std::vector<std::byte>& out, std::string_view text) {
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    out.insert(out.end(), begin, begin + text.size());
}

}  // namespace eventide
