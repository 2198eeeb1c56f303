// See toml_text.h.
#include "src/settings/toml_text.h"

#include "src/core/error.h"
#include "src/core/utf8.h"
#include "src/io/input_file.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace eventide {
namespace {

bool is_ascii(char c) {
    return static_cast<unsigned char>(c) < 0x80;
}

/// Of a bare or quoted key, or what toml++ refuses itself: nothing.
bool may_begin_a_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view{"_-\"']"}.find(c) != std::string_view::npos;
}

bool is_blank(char c) {
    return std::string_view{" \t\r\n"}.find(c) != std::string_view::npos;
}

std::string escape_sequence(char32_t code) {
    char text[16];
    std::snprintf(text, sizeof text, code > 0xFFFF ? "\\U%08X" : "\\u%04X", unsigned(code));
    return text;
}

/// Walks through TOML as far as it is sound, which is as far as toml++ comes: past strings,
/// comments and lists, so that only what begins a table's header is taken for one. What it has
/// passed stands in plain(), in ASCII.
class Walk {
public:
    Walk(const std::string& path, std::string_view text) : path_(path), rest_(text) {
        if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
    }

    /// To the name of the next table, behind its brackets; false: there is none.
    bool next_table() {
        while (!rest_.empty()) {
            if (std::exchange(begins_line_, false) && depth_ == 0) {
                skip_blanks();
                if (rest_.starts_with('[')) {
                    last_ = '\n';
                    take(rest_.starts_with("[[") ? 2 : 1);
                    skip_blanks();
                    return true;
                }
            }
            step();
        }
        return false;
    }
    std::string_view rest() const { return rest_; }
    const std::string& plain() const { return plain_; }
    [[noreturn]] void refuse(const std::string& wanted) const {
        const char found = rest_.front();
        throw Error(ErrorKind::usage, path_ + ":" + std::to_string(line_) + ": expected " + wanted +
                                          ", found " +
                                          (found == '\n' ? std::string{"the end of the line"}
                                                         : std::string{'\'', found, '\''}));
    }

private:
    /// Past one character, or one string or comment.
    void step() {
        if (rest_.empty()) return;
        const char c = rest_.front();
        if (c == '#') return take_comment();
        if (!is_ascii(c)) refuse("letters without accents outside quotes");
        if (c == '}' && (last_ == '[' || last_ == ',')) refuse("a value or the end of the list");
        if (!is_blank(c)) last_ = c;
        if (c == '"') return take_basic(rest_.starts_with("\"\"\""));
        if (c == '\'') return take_literal(rest_.starts_with("\'\'\'"));
        if (c == '[') ++depth_;
        if (c == ']' && depth_ > 0) --depth_;
        begins_line_ = c == '\n';
        take(1);
    }

    void take_comment() {
        while (!rest_.empty() && rest_.front() != '\n') take_character();
    }

    /// A string with escape sequences.
    void take_basic(bool is_long) {
        const std::string_view quotes = is_long ? "\"\"\"" : "\"";
        take(quotes.size());
        while (!rest_.empty() && (is_long || rest_.front() != '\n')) {
            if (rest_.starts_with(quotes)) {
                take(quotes.size());
                // Two more may be the end of what it says.
                for (int i = 0; i < 2 && is_long && rest_.starts_with('"'); ++i) take(1);
                return;
            }
            if (rest_.front() == '\\') {
                take(1);
                if (!rest_.empty() && !is_ascii(rest_.front())) refuse("an escape sequence");
                take(1);
            } else {
                take_character();
            }
        }
    }

    /// One without. Where it is not ASCII alone it becomes one with them.
    void take_literal(bool is_long) {
        const std::size_t quotes = is_long ? 3 : 1;
        const std::string_view inside = rest_.substr(quotes);
        std::size_t length = is_long ? inside.find("\'\'\'") : inside.find_first_of("'\n");
        const bool is_ended = length < inside.size() && inside[length] == '\'';
        length = std::min(length, inside.size());
        for (int i = 0; i < 2 && is_long && is_ended && inside.substr(length + 3).starts_with('\'');
             ++i)
            ++length;
        if (std::ranges::all_of(inside.substr(0, length), is_ascii))
            return take(quotes + length + (is_ended ? quotes : 0));
        const std::size_t end = rest_.size() - quotes - length;
        plain_.append(quotes, '"');
        skip(quotes);
        while (rest_.size() > end) {
            if (rest_.front() == '\\' || rest_.front() == '"') plain_ += '\\';
            take_character();
        }
        if (!is_ended) return;
        plain_.append(quotes, '"');
        skip(quotes);
    }

    /// Of a string or comment.
    void take_character() {
        if (is_ascii(rest_.front())) return take(1);
        const Character character = first_character(rest_);
        if (character.bytes == 0) refuse("UTF-8");
        plain_ += escape_sequence(character.code);
        skip(character.bytes);
    }

    void skip_blanks() { take(std::min(rest_.find_first_not_of(" \t"), rest_.size())); }
    void take(std::size_t n) {
        plain_ += rest_.substr(0, n);
        skip(n);
    }
    void skip(std::size_t n) {
        const std::string_view passed = rest_.substr(0, n);
        line_ += int(std::ranges::count(passed, '\n'));
        rest_.remove_prefix(passed.size());
    }

    const std::string& path_;
    std::string_view rest_;
    int line_ = 1, depth_ = 0;  // depth: of lists
    bool begins_line_ = true;
    char last_ = '\n';  // but blanks and comments
    std::string plain_;
};

}  // namespace

std::string plain_toml(const std::string& path, std::string_view text) {
    Walk walk{path, text};
    while (walk.next_table())
        if (!walk.rest().empty() && !may_begin_a_name(walk.rest().front()))
            walk.refuse("the name of a table after '['");
    return walk.plain();
}

std::string read_toml_text(const std::filesystem::path& path) {
    return plain_toml(path.string(), read_text_file(path, ErrorKind::usage));
}

}  // namespace eventide
