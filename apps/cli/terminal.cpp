// Standard error: the logger, and one moving line.
#include "apps/cli/terminal.h"

#include "apps/cli/printable.h"
#include "apps/cli/service_manager.h"
#include "src/core/environment.h"
#include "src/core/error.h"

#include <fcntl.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

namespace eventide::app {

namespace {

/// The message in a log line, with nothing in it that a terminal would obey: it may hold names and
/// texts out of files.
class PrintableMessage final : public spdlog::custom_flag_formatter {
public:
    void format(const spdlog::details::log_msg& message, const std::tm&,
                spdlog::memory_buf_t& into) override {
        const std::string text =
            printable({message.payload.data(), message.payload.size()}, Lines::keep);
        into.append(text.data(), text.data() + text.size());
    }
    std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
        return std::make_unique<PrintableMessage>();
    }
};

/// The same, each line behind what journald takes for its priority.
class JournalMessage final : public spdlog::custom_flag_formatter {
public:
    void format(const spdlog::details::log_msg& message, const std::tm&,
                spdlog::memory_buf_t& into) override {
        const bool serious = message.level >= spdlog::level::err;
        const std::string priority = serious                                ? "<3>"
                                     : message.level == spdlog::level::warn ? "<4>"
                                     : message.level == spdlog::level::info ? "<6>"
                                                                            : "<7>";
        std::string text = priority;
        for (const char c :
             printable({message.payload.data(), message.payload.size()}, Lines::keep)) {
            text += c;
            if (c == '\n') text += priority;
        }
        into.append(text.data(), text.data() + text.size());
    }
    std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
        return std::make_unique<JournalMessage>();
    }
};

}  // namespace

void start_log(const LogSettings& settings) {
    auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(
        colour_allowed() ? spdlog::color_mode::always : spdlog::color_mode::never);
    auto logger = std::make_shared<spdlog::logger>("eventide", std::move(sink));
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    // The journal knows the program's name and keeps the priority apart.
    formatter->add_flag<PrintableMessage>('*').add_flag<JournalMessage>('&').set_pattern(
        writes_to_journal() ? "%&" : "%n: %^%l%$: %*");
    logger->set_formatter(std::move(formatter));
    auto level = spdlog::level::from_str(settings.log_level);
    if (settings.quiet) level = std::max(level, spdlog::level::warn);
    logger->set_level(level);
    spdlog::set_default_logger(std::move(logger));
}

bool on_terminal() {
    const char* terminal = environment_value("TERM");
    return isatty(STDERR_FILENO) == 1 &&
           (terminal == nullptr || std::string_view{terminal} != "dumb");
}

namespace {

bool is_terminal(const std::string& path) {
    if (path == "-") return isatty(STDOUT_FILENO) == 1;
    std::error_code none;
    if (!std::filesystem::is_character_file(path, none)) return false;
    const int file = ::open(path.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) return false;
    const bool terminal = isatty(file) == 1;
    ::close(file);
    return terminal;
}

}  // namespace

void refuse_terminal(const std::string& option, const std::string& path, bool force) {
    if (force || !is_terminal(path)) return;
    throw Error(ErrorKind::usage, option + ": expected a pipe or a file" +
                                      (path == "-" ? " as standard output" : "") +
                                      ", found a terminal; --force writes to it all the same");
}

bool colour_allowed() {
    const char* refused = environment_value("NO_COLOR");
    return on_terminal() && (refused == nullptr || *refused == '\0');
}

std::size_t ProgressLine::columns() const {
    constexpr std::size_t kUsual = 80;
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    return (known ? size.ws_col : kUsual) - 1;  // the last column would begin a new line
}

void ProgressLine::show(std::string_view text) {
    if (!active_) return;
    const std::string safe = printable(text);
    text = std::string_view{safe}.substr(0, columns());
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

std::string tight_count(std::uint64_t n) {
    std::string text = short_count(double(n));
    std::erase(text, ' ');
    return text;
}

}  // namespace eventide::app
