// One of a few words: each beside the value it stands for.
#pragma once

#include "src/core/error.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

template <typename T>
struct Word {
    T value;
    std::string_view text;
};

/// Nothing where `text` is none of them.
template <typename T>
std::optional<T> find_word(std::string_view text, const std::vector<Word<T>>& words) {
    for (const Word<T>& word : words)
        if (word.text == text) return word.value;
    return std::nullopt;
}

/// `value` is one of them.
template <typename T>
std::string show_word(const T& value, const std::vector<Word<T>>& words) {
    for (const Word<T>& word : words)
        if (word.value == value) return std::string{word.text};
    return {};
}

template <typename T>
std::vector<std::string> texts_of(const std::vector<Word<T>>& words) {
    std::vector<std::string> texts;
    texts.reserve(words.size());
    for (const Word<T>& word : words) texts.emplace_back(word.text);
    return texts;
}

/// "a, b or c", each between `quotes`.
inline std::string alternatives(const std::vector<std::string>& names,
                                const std::string& quotes = {}) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
        text.append(quotes).append(names[i]).append(quotes);
    }
    return text;
}

/// The value of an option. Throws Error (usage): "NAME: expected a, b or c, found ...".
template <typename T>
T option_word(const std::string& name, std::string_view text, const std::vector<Word<T>>& words) {
    if (const std::optional<T> value = find_word(text, words)) return *value;
    throw Error(ErrorKind::usage, name + ": expected " + alternatives(texts_of(words)) +
                                      ", found '" + std::string{text} + "'");
}

}  // namespace eventide
