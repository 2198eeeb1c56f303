// What may have been meant by a word that is none.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace eventide {

/// "; did you mean --fps?" for the nearest of the words, or one that begins with the typed one or
/// the other way round; empty where none is near.
std::string suggestion(std::string_view typed, const std::vector<std::string>& words);

}  // namespace eventide
