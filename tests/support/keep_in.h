// What is told in warnings, kept to look at.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace eventide::test {

/// A callback that adds each text to `texts`, which outlives it.
inline std::function<void(const std::string&)> keep_in(std::vector<std::string>& texts) {
    return [&texts](const std::string& text) { texts.push_back(text); };
}

}  // namespace eventide::test
