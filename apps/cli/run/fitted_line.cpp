// One line for a terminal of any width.
#include "apps/cli/run/fitted_line.h"

#include <algorithm>
#include <cstdio>

namespace eventide::app {

namespace {

constexpr std::size_t kBar = 24, kShortBar = 10;

std::string bar_of(double share, std::size_t width) {
    const auto filled = std::size_t(share * double(width));
    std::string bar(filled, '=');
    if (filled < width) bar += '>';
    bar.resize(width, ' ');
    return "[" + bar + "] ";
}

std::string join(const std::vector<LinePart>& parts, const std::vector<std::size_t>& forms) {
    std::string line;
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (!parts[i].empty() && !parts[i][forms[i]].empty())
            line += (line.empty() ? "" : "  ") + parts[i][forms[i]];
    return line;
}

/// "1:23" or "1:02:03".
std::string clock_text(double seconds) {
    const auto s = static_cast<long long>(std::min(seconds, 3.6e6));
    char text[32];
    if (s < 3600)
        std::snprintf(text, sizeof text, "%lld:%02lld", s / 60, s % 60);
    else
        std::snprintf(text, sizeof text, "%lld:%02lld:%02lld", s / 3600, s / 60 % 60, s % 60);
    return text;
}

}  // namespace

std::string fitted_line(const std::vector<LinePart>& parts, std::span<const std::size_t> gives_way,
                        std::size_t columns) {
    std::vector<std::size_t> forms(parts.size(), 0);
    std::string line = join(parts, forms);
    for (const std::size_t i : gives_way) {
        if (line.size() <= columns) break;
        if (forms[i] + 1 >= parts[i].size()) continue;
        ++forms[i];
        line = join(parts, forms);
    }
    return line.substr(0, columns);
}

LinePart share_part(double share) {
    share = std::clamp(share, 0.0, 1.0);
    char text[16];
    std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
    const std::string number = text,
                      padded =
                          std::string(5 - std::min<std::size_t>(number.size(), 5), ' ') + number;
    return {bar_of(share, kBar) + padded, bar_of(share, kShortBar) + padded, number};
}

LinePart left_part(std::chrono::duration<double> elapsed, double share) {
    // Before that the first buffers' filling is most of what was measured.
    constexpr double kLeastShare = 0.005;
    constexpr std::chrono::duration<double> kLeastElapsed{1};
    if (share < kLeastShare || elapsed < kLeastElapsed) return {};
    const std::string left = clock_text(elapsed.count() * (1 / std::min(share, 1.0) - 1));
    return {left + " left", "-" + left, ""};
}

}  // namespace eventide::app
