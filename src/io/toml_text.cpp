// See toml_text.h.
#include "src/io/toml_text.h"

#include "src/core/error.h"
#include "src/io/input_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace eventide {
namespace {

/// Of a bare or quoted key, or what toml++ refuses itself: nothing, a second bracket, an end.
bool may_begin_a_name(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view{"_-\"'[]"}.find(c) != std::string_view::npos || byte == '\r';
}

}  // namespace

void check_table_names(const std::string& path, std::string_view text) {
    constexpr std::string_view kBlank = " \t";
    int number = 0;
    while (!text.empty()) {
        ++number;
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
        if (!line.starts_with('[')) continue;
        line.remove_prefix(line.starts_with("[[") ? 2 : 1);
        line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
        if (!line.empty() && !may_begin_a_name(line.front()))
            throw Error(ErrorKind::usage, path + ":" + std::to_string(number) +
                                              ": expected the name of a table after '[', found '" +
                                              line.front() + "'");
    }
}

std::string read_toml_text(const std::filesystem::path& path) {
    std::ifstream stream = open_to_read(path, ErrorKind::usage);
    std::string text{std::istreambuf_iterator<char>{stream}, {}};
    check_table_names(path.string(), text);
    return text;
}

}  // namespace eventide
