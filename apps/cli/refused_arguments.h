// What to say of arguments that CLI11 did not understand.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace eventide::app {

/// The command that was given; empty: none.
std::string command_of(const CLI::App& app);

/// Throws Error (usage). Of all arguments that were not expected, the first says most.
[[noreturn]] void refuse_extras(const std::vector<std::string>& arguments, const CLI::App& app,
                                const std::string& command);

/// CLI11 takes the word behind an option for its value, also where that is the next option: of
/// `--stats --quiet` it would make a file of that name. Throws Error (usage).
void refuse_forgotten_values(const std::vector<std::string>& arguments, const CLI::App& app);

/// CLI11's "--fps: 1 required RATE missing" in our words; everything else as it is.
std::string in_our_words(const std::string& text);

}  // namespace eventide::app
