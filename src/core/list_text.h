// Lists in messages.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace eventide {

/// `item` at the end of "a, b".
inline void add_to_list(std::string& list, std::string_view item) {
    if (!list.empty()) list += ", ";
    list += item;
}

/// "a, b, c": what `text` makes of each.
template <typename Items, typename Text = std::identity>
std::string list_of(const Items& items, Text text = {}) {
    std::string list;
    for (const auto& item : items) add_to_list(list, std::invoke(text, item));
    return list;
}

}  // namespace eventide
