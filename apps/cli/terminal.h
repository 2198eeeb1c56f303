// What the program says to people: on standard error, in colour and with a moving line only where
// somebody looks at a terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace eventide::app {

struct LogSettings {
    std::string log_level = "info";  ///< trace, debug, info, warning, error or off
    bool quiet = false;              ///< no progress and no summaries; warnings and errors stay
};

/// Sets spdlog's default logger; once, before anything is logged.
void start_log(const LogSettings& settings);

/// Standard error is a terminal that obeys escape sequences: not TERM=dumb, as of editors' shells.
bool on_terminal();

/// Throws Error (usage) where `path` ("-": standard output) is a terminal, which frames and packed
/// events would only garble. `option` is what asked for it; --force allows it.
void refuse_terminal(const std::string& option, const std::string& path, bool force);

/// Whether colour may be used: on a terminal, unless NO_COLOR is set to something (no-color.org).
bool colour_allowed();

/// One line at the bottom of a terminal, redrawn in place. Silent where standard error is no such
/// terminal or when told to be quiet. Thread: one at a time.
class ProgressLine {
public:
    explicit ProgressLine(bool quiet) : active_{!quiet && on_terminal()} {}
    ~ProgressLine() { clear(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    bool active() const { return active_; }
    /// How long a line may be.
    std::size_t columns() const;
    void show(std::string_view text);
    /// Takes the line away before something else is printed.
    void clear();

private:
    bool active_, drawn_ = false;
};

/// 12,345,678 -> "12.3 M"; for rates and counts in lines people read.
std::string short_count(double n);
/// The same without the space before the unit.
std::string tight_count(std::uint64_t n);

}  // namespace eventide::app
