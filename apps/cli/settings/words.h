// Words and limits that several commands take.
#pragma once

#include "src/core/arithmetic_words.h"
#include "src/core/bayer.h"
#include "src/core/error.h"
#include "src/core/instructions.h"
#include "src/core/number_text.h"
#include "src/model/engine.h"
#include "src/settings/setting.h"
#include "src/settings/words.h"

#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace eventide::app {

/// Threads that the network may use.
constexpr int kMaxThreads = 1024;

inline const std::vector<Word<Engine>> kEngineWords{{Engine::plain, "plain"},
                                                    {Engine::fast, "fast"}};
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

/// --bayer of a source; empty: auto, what the source says.
inline Setting bayer_setting(std::optional<ColourFilter>& filter, std::string help) {
    return open_setting<ColourFilter>(
        "bayer", filter, "auto|none|rggb|grbg|gbrg|bggr", std::move(help), "auto",
        [](const std::string& text) { return parse_word(text, bayer_words()); },
        [](const ColourFilter& f) { return std::string{name_of(f)}; });
}

/// Throws Error (usage) naming the option whose list a configuration file or the environment left
/// empty.
inline void require_some(const char* option, const std::vector<std::string>& list) {
    if (list.empty())
        throw Error(ErrorKind::usage,
                    std::string{option} + ": expected one or more, found an empty list");
}

/// --self-ensemble.
inline Setting self_ensemble_setting(int& views, std::string help) {
    Setting setting = whole_setting("self_ensemble", views, "1|2|4", std::move(help), 1, 4);
    setting.set = [&views](const SettingValue& given) {
        const auto asked = number_in<int>(given.text);
        if (!given.may_be(ValueKind::number) || (asked != 1 && asked != 2 && asked != 4))
            given.refuse("1, 2 or 4");
        views = *asked;
    };
    return setting;
}

}  // namespace eventide::app
