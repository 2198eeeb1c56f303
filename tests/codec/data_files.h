// Real recordings, where they are at hand.
#pragma once

#include "src/core/event.h"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace eventide {

/// A file of shared/data/formats; empty where there is none.
inline std::vector<std::byte> read_data_file(const std::string& name) {
    std::ifstream file(EVENTIDE_SOURCE_DIR "/../shared/data/formats/" + name, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    return {begin, begin + text.size()};
}

inline std::size_t count_on(const std::vector<Event>& events) {
    return std::size_t(std::count_if(events.begin(), events.end(),
                                     [](const Event& e) { return e.polarity == Polarity::on; }));
}

}  // namespace eventide
