// JSON that is safe to copy, compare and print, which nlohmann's library does by recursion: a file
// of brackets alone would take more stack than there is.
#pragma once

#include <nlohmann/json.hpp>

namespace eventide {

/// As Json::parse(): discarded where it is no JSON. What is nested deeper than anything of ours is
/// left out. `input`: text, or a stream.
template <typename Json, typename Input>
Json parse_shallow_json(Input&& input) {
    constexpr int kLevels = 64;
    const auto is_shallow = [](int depth, typename Json::parse_event_t, Json&) {
        return depth < kLevels;
    };
    return Json::parse(std::forward<Input>(input), is_shallow, /*allow_exceptions=*/false);
}

}  // namespace eventide
