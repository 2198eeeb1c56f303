// The settings that are one of a few words: each word beside the enumerator it stands for.
#pragma once

#include "apps/cli/settings/values.h"
#include "src/core/bayer.h"
#include "src/model/engine.h"
#include "src/model/instructions.h"

#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace eventide::app {

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
    return words[parse_choice(text, texts_of(words))].value;
}

/// `value` is one of them.
template <typename Enum>
std::string show_word(Enum value, const std::vector<Word<Enum>>& words) {
    for (const Word<Enum>& word : words)
        if (word.value == value) return std::string{word.text};
    return {};
}

// What several commands take.
inline const std::vector<Word<Engine>> kEngineWords{{Engine::plain, "plain"},
                                                    {Engine::fast, "fast"}};
inline const std::vector<Word<Precision>> kPrecisionWords{
    {Precision::automatic, "auto"}, {Precision::f32, "f32"}, {Precision::bf16, "bf16"}};
inline const std::vector<Word<Instructions>> kInstructionWords{{Instructions::best, "best"},
                                                               {Instructions::avx512, "avx512"},
                                                               {Instructions::avx2, "avx2"},
                                                               {Instructions::sse4, "sse4"}};

/// As name_of() has them.
inline const std::vector<Word<ColourFilter>>& bayer_words() {
    static const std::vector<Word<ColourFilter>> words = [] {
        std::vector<Word<ColourFilter>> all;
        all.reserve(std::size(kColourFilters));
        for (const ColourFilter filter : kColourFilters) all.push_back({filter, name_of(filter)});
        return all;
    }();
    return words;
}

}  // namespace eventide::app
