// What this process holds: /proc.
#include "apps/cli/stress/process_size.h"

#include "src/core/number_text.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace eventide::stress {
namespace {

int entries(const char* folder) {
    std::error_code error;
    const std::filesystem::directory_iterator first{folder, error};
    return error ? 0 : int(std::distance(begin(first), end(first)));
}

/// Bytes of a line "name: n kB".
std::int64_t bytes_of(const char* path, const std::string& name) {
    std::ifstream file{path};
    for (std::string word, value, rest; file >> word >> value; std::getline(file, rest))
        if (word == name) return number_in<std::int64_t>(value).value_or(0) << 10;
    return 0;
}

}  // namespace

ProcessSize process_size() {
    return {bytes_of("/proc/self/status", "VmRSS:"), entries("/proc/self/fd"),
            entries("/proc/self/task")};
}

std::uint64_t free_memory() {
    return std::uint64_t(bytes_of("/proc/meminfo", "MemAvailable:"));
}

}  // namespace eventide::stress
