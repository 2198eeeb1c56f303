// Settings that are one of a few words.
#pragma once

#include "src/core/words.h"
#include "src/settings/values.h"

#include <string>
#include <vector>

namespace eventide {

/// Throws Error (usage): "expected auto, f32 or bf16, found ...".
template <typename Enum>
Enum parse_word(const std::string& text, const std::vector<Word<Enum>>& words) {
    if (const auto value = find_word(text, words)) return *value;
    throw_usage(alternatives(texts_of(words)), text);
}

}  // namespace eventide
