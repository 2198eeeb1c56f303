// fork, exec, pipes: a program under test.
#include "tests/system/process.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace eventide::test {

TempFolder::TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "eventide_test_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder");
    path_ = name;
}

TempFolder::~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::string read_text(const std::filesystem::path& file) {
    std::ifstream stream{file, std::ios::binary};
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream{file, std::ios::binary} << text;
}

namespace {

void redirect(const std::string& file, int flags, int target) {
    const int opened = open(file.c_str(), flags, 0600);
    dup2(opened, target);
    close(opened);
}

/// In the child; never returns.
[[noreturn]] void become(const std::vector<std::string>& arguments,
                         const ProcessSettings& settings) {
    for (const auto& [name, value] : settings.environment)
        if (value.empty())
            unsetenv(name.c_str());
        else
            setenv(name.c_str(), value.c_str(), 1);
    if (!settings.folder.empty() && chdir(settings.folder.c_str()) != 0) _exit(127);
    std::vector<char*> argv;
    for (const std::string& argument : arguments)
        argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execvp(argv[0], argv.data());
    _exit(127);
}

}  // namespace

Process::Process(const std::vector<std::string>& arguments, ProcessSettings settings) {
    write_text(files_ / "input", settings.input);
    std::array<int, 2> pipe_ends{-1, -1};
    if (settings.output_to_pipe && pipe2(pipe_ends.data(), O_CLOEXEC) != 0)
        throw std::runtime_error("cannot make a pipe");
    int terminal_end = -1;
    if (settings.error_to_terminal || settings.output_to_terminal) {
        const winsize size{24, static_cast<unsigned short>(settings.terminal_columns), 0, 0};
        if (openpty(&terminal_, &terminal_end, nullptr, nullptr, &size) != 0)
            throw std::runtime_error("cannot make a terminal");
    }
    output_to_terminal_ = settings.output_to_terminal;
    error_to_terminal_ = settings.error_to_terminal;
    child_ = fork();
    if (child_ == 0) {
        redirect(files_ / "input", O_RDONLY, STDIN_FILENO);
        if (settings.output_to_pipe)
            dup2(pipe_ends[1], STDOUT_FILENO);
        else if (settings.output_to_terminal)
            dup2(terminal_end, STDOUT_FILENO);
        else
            redirect(files_ / "output", O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
        if (settings.error_to_terminal)
            dup2(terminal_end, STDERR_FILENO);
        else
            redirect(files_ / "error", O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
        become(arguments, settings);
    }
    if (settings.output_to_pipe) close(pipe_ends[1]);
    if (terminal_end >= 0) close(terminal_end);
    output_ = pipe_ends[0];
}

Process::~Process() {
    if (running()) {
        signal(SIGKILL);
        wait();
    }
    close_output();
    if (terminal_ >= 0) close(terminal_);
}

std::string Process::read_output(std::size_t n) {
    std::string bytes(n, '\0');
    std::size_t got = 0;
    while (got < n) {
        const ssize_t more = read(output_, bytes.data() + got, n - got);
        if (more < 0 && errno == EINTR) continue;
        if (more <= 0) break;
        got += std::size_t(more);
    }
    bytes.resize(got);
    return bytes;
}

void Process::close_output() {
    if (output_ >= 0) close(output_);
    output_ = -1;
}

bool Process::catches(int number) const {
    const std::string status = read_text("/proc/" + std::to_string(child_) + "/status");
    const std::string name = "SigCgt:";
    const std::size_t at = status.find(name);
    if (at == status.npos) return false;
    const unsigned long long caught = std::stoull(status.substr(at + name.size()), nullptr, 16);
    return (caught >> (number - 1) & 1) != 0;
}

void Process::signal(int number) {
    if (!status_) kill(child_, number);
}

bool Process::running() {
    if (status_) return false;
    int status = 0;
    if (waitpid(child_, &status, WNOHANG) == child_) status_ = status;
    return !status_;
}

/// Reads what the terminal got until the child's end is closed.
void Process::collect_terminal() {
    std::array<char, 4096> part{};
    for (;;) {
        const ssize_t n = read(terminal_, part.data(), part.size());
        if (n <= 0) return;  // EIO: nobody holds the other end any more
        terminal_text_.append(part.data(), std::size_t(n));
    }
}

Result Process::wait() {
    Result result;
    if (output_ >= 0)
        for (std::string part; !(part = read_output(1 << 16)).empty();) read_ += part;
    if (terminal_ >= 0) collect_terminal();
    if (!status_) {
        int status = 0;
        while (waitpid(child_, &status, 0) < 0 && errno == EINTR) continue;
        status_ = status;
    }
    result.exit_code = WIFEXITED(*status_) ? WEXITSTATUS(*status_) : 128 + WTERMSIG(*status_);
    result.output = output_to_terminal_ ? terminal_text_
                    : read_.empty()     ? read_text(files_ / "output")
                                        : read_;
    result.error = error_to_terminal_ ? terminal_text_ : read_text(files_ / "error");
    return result;
}

Result run(const std::vector<std::string>& arguments, ProcessSettings settings) {
    return Process{arguments, std::move(settings)}.wait();
}

}  // namespace eventide::test
