// Runs a program as a user would: arguments, environment, standard input, output, exit code,
// signals.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace eventide::test {

/// A folder of its own for each test, removed with everything in it.
class TempFolder {
public:
    TempFolder();
    ~TempFolder();
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

private:
    std::filesystem::path path_;
};

std::string read_text(const std::filesystem::path& file);
void write_text(const std::filesystem::path& file, const std::string& text);

struct ProcessSettings {
    std::map<std::string, std::string> environment = {};  ///< added to ours; an empty value removes
    std::string input = {};                               ///< on standard input
    std::string folder = {};                              ///< to run in; empty = here
    bool output_to_pipe = false;      ///< standard output is read by read_output()
    bool error_to_terminal = false;   ///< standard error is a (pseudo) terminal
    bool output_to_terminal = false;  ///< standard output is, the same one
    int terminal_columns = 0;         ///< how wide it is; 0: it does not say
};

struct Result {
    int exit_code = -1;  ///< 128 + n for signal n
    std::string output, error;
};

class Process {
public:
    explicit Process(const std::vector<std::string>& arguments, ProcessSettings settings = {});
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// With output_to_pipe: waits for exactly n bytes (fewer at the end).
    std::string read_output(std::size_t n);
    /// The reader goes away.
    void close_output();
    /// What it has written to standard error so far, where that is no terminal.
    std::string error_so_far() const { return read_text(files_ / "error"); }
    void signal(int number);
    /// Whether it has a handler for this signal by now.
    bool catches(int number) const;
    bool running();
    Result wait();

private:
    void collect_terminal();

    TempFolder files_;
    pid_t child_ = -1;
    int output_ = -1, terminal_ = -1;
    bool output_to_terminal_ = false, error_to_terminal_ = false;
    std::string read_, terminal_text_;
    std::optional<int> status_;
};

/// Runs to the end.
Result run(const std::vector<std::string>& arguments, ProcessSettings settings = {});

}  // namespace eventide::test
