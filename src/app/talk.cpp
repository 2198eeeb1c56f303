// Standard error: the logger, and one moving line.
#include "src/app/talk.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace eventide::app {

void start_talk(const TalkSettings& settings) {
    auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(
        colour_allowed() ? spdlog::color_mode::always : spdlog::color_mode::never);
    auto logger = std::make_shared<spdlog::logger>("eventide", std::move(sink));
    logger->set_pattern("%n: %^%l%$: %v");
    auto level = spdlog::level::from_str(settings.log_level);
    if (settings.quiet) level = std::max(level, spdlog::level::warn);
    logger->set_level(level);
    spdlog::set_default_logger(std::move(logger));
}

bool on_terminal() {
    return isatty(STDERR_FILENO) == 1;
}

bool colour_allowed() {
    const char* refused = std::getenv("NO_COLOR");
    const char* terminal = std::getenv("TERM");
    return on_terminal() && (refused == nullptr || *refused == '\0') &&
           (terminal == nullptr || std::string_view{terminal} != "dumb");
}

void ProgressLine::show(std::string_view text) {
    if (!active_) return;
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    const std::size_t columns = known ? size.ws_col - 1U : 79U;
    text = text.substr(0, columns);
    // Return to the first column, write, clear what is left of the line before.
    std::fprintf(stderr, "\r%.*s\033[K", int(text.size()), text.data());
    std::fflush(stderr);
    drawn_ = true;
}

void ProgressLine::clear() {
    if (!drawn_) return;
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
    drawn_ = false;
}

std::string progress_bar(double share) {
    constexpr int kWidth = 24;
    const int filled = int(std::clamp(share, 0.0, 1.0) * kWidth);
    std::string bar(std::size_t(filled), '=');
    if (filled < kWidth) bar += '>';
    bar.resize(kWidth, ' ');
    char text[16];
    std::snprintf(text, sizeof text, "%3.0f %%", 100 * std::clamp(share, 0.0, 1.0));
    return "[" + bar + "] " + text;
}

std::string short_count(double n) {
    const char* unit = "";
    for (const char* next : {" k", " M", " G", " T"}) {
        if (n < 999.5) break;
        n /= 1000;
        unit = next;
    }
    char text[32];
    std::snprintf(text, sizeof text, n < 99.95 && *unit != '\0' ? "%.1f%s" : "%.0f%s", n, unit);
    return text;
}

}  // namespace eventide::app
