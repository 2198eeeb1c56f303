// Names without regard to large and small letters.
#pragma once

#include <string>
#include <string_view>

namespace eventide {

/// A to Z become a to z, whatever the locale; the rest stays.
inline std::string lower_case(std::string_view text) {
    std::string lower{text};
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return lower;
}

}  // namespace eventide
