// By the number of letters to insert, remove, replace or swap.
#include "src/settings/suggestion.h"

#include <algorithm>
#include <utility>

namespace eventide {

namespace {

/// Damerau and Levenshtein's distance, of neighbours swapped at most once.
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                d[i][j] = i + j;
                continue;
            }
            const std::size_t replaced = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            d[i][j] = std::min({replaced, d[i - 1][j] + 1, d[i][j - 1] + 1});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

/// --output is --out, eval evaluate.
bool one_begins_the_other(std::string_view a, std::string_view b) {
    constexpr std::size_t kFewest = 3;  // letters that say something
    if (a.size() > b.size()) std::swap(a, b);
    return a.size() >= kFewest && b.starts_with(a);
}

}  // namespace

std::string suggestion(std::string_view typed, const std::vector<std::string>& words) {
    const std::size_t most = std::clamp<std::size_t>(typed.size() / 3, 1, 3);
    const std::string* best = nullptr;
    std::size_t least = most + 1;
    for (const std::string& word : words) {
        const std::size_t apart =  // at least
            std::max(typed.size(), word.size()) - std::min(typed.size(), word.size());
        const std::size_t n = one_begins_the_other(typed, word) ? std::min(apart, most)
                              : apart < least                   ? distance(typed, word)
                                                                : apart;
        if (n >= least) continue;
        best = &word;
        least = n;
    }
    return best ? "; did you mean " + *best + "?" : "";
}

}  // namespace eventide
