// Settings that are one of a few words: each word beside the enumerator it stands for.
#pragma once

#include "src/settings/values.h"

#include <string>
#include <string_view>
#include <vector>

namespace eventide {

template <typename Enum>
struct Word {
    Enum value;
    std::string_view text;
};

template <typename Enum>
std::vector<std::string> texts_of(const std::vector<Word<Enum>>& words) {
    std::vector<std::string> texts;
    for (const Word<Enum>& word : words) texts.emplace_back(word.text);
    return texts;
}

/// Throws Error (usage): "expected auto, f32 or bf16, found ...".
template <typename Enum>
Enum parse_word(const std::string& text, const std::vector<Word<Enum>>& words) {
    for (const Word<Enum>& word : words)
        if (word.text == text) return word.value;
    throw_usage(alternatives(texts_of(words)), text);
}

/// `value` is one of them.
template <typename Enum>
std::string show_word(Enum value, const std::vector<Word<Enum>>& words) {
    for (const Word<Enum>& word : words)
        if (word.value == value) return std::string{word.text};
    return {};
}

}  // namespace eventide
