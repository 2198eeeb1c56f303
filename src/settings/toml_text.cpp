// See toml_text.h.
#include "src/settings/toml_text.h"

#include "src/core/error.h"
#include "src/io/input_file.h"

#include <algorithm>
#include <utility>

namespace eventide {
namespace {

/// Of a bare or quoted key, or what toml++ refuses itself: nothing.
bool may_begin_a_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view{"_-\"']"}.find(c) != std::string_view::npos;
}

bool is_blank(char c) {
    return std::string_view{" \t\r\n"}.find(c) != std::string_view::npos;
}

/// Of a quote behind anything else toml++ says that it is part of a word.
bool may_stand_before_a_string(char c) {
    return is_blank(c) || std::string_view{"=[,{."}.find(c) != std::string_view::npos;
}

/// Walks through TOML as far as it is sound, which is as far as toml++ comes: past strings,
/// comments and lists, so that only what begins a table's header is taken for one.
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
        if (c == '#') return take(std::min(rest_.find('\n'), rest_.size()));
        if (static_cast<unsigned char>(c) >= 0x80) refuse("letters without accents outside quotes");
        if (c == '}' && (last_ == '[' || last_ == ',')) refuse("a value or the end of the list");
        if (!is_blank(c)) last_ = c;
        if (c == '"' || c == '\'') {
            if (!may_stand_before_a_string(before_)) refuse("no quote within a word");
            return skip_string(c);
        }
        if (c == '[') ++depth_;
        if (c == ']' && depth_ > 0) --depth_;
        begins_line_ = c == '\n';
        take(1);
    }

    void skip_string(char quote) {
        const std::string three(3, quote);
        const bool is_long = rest_.starts_with(three);
        take(is_long ? 3 : 1);
        while (!rest_.empty() && (is_long || rest_.front() != '\n')) {
            if (is_long ? rest_.starts_with(three) : rest_.front() == quote) {
                take(is_long ? 3 : 1);
                // Two more may be the end of what it says.
                for (int i = 0; i < 2 && is_long && rest_.starts_with(quote); ++i) take(1);
                return;
            }
            if (quote == '"' && rest_.front() == '\\')
                skip_escape(is_long);
            else
                take(1);
        }
    }

    /// In a long string all blanks behind a backslash are left out; toml++ asks whether what
    /// follows is one more, and has no answer for some of U+FCC0 to U+FEFF.
    void skip_escape(bool is_long) {
        take(1);
        const std::size_t blanks = std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size());
        const std::string_view next = rest_.substr(is_long ? blanks : rest_.size());
        if (next.size() > 1 && next[0] == '\xEF' && next[1] >= '\xB3' && next[1] <= '\xBB') {
            take(blanks);
            refuse("no letter from U+FCC0 to U+FEFF behind a backslash");
        }
        take(1);
    }

    void skip_blanks() { take(std::min(rest_.find_first_not_of(" \t"), rest_.size())); }
    void take(std::size_t n) {
        const std::string_view taken = rest_.substr(0, n);
        line_ += int(std::ranges::count(taken, '\n'));
        if (!taken.empty()) before_ = taken.back();
        rest_.remove_prefix(taken.size());
    }

    const std::string& path_;
    std::string_view rest_;
    int line_ = 1, depth_ = 0;  // depth: of lists
    bool begins_line_ = true;
    char before_ = '\n', last_ = '\n';  // last: but blanks and comments
};

}  // namespace

void check_toml(const std::string& path, std::string_view text) {
    Walk walk{path, text};
    while (walk.next_table())
        if (!walk.rest().empty() && !may_begin_a_name(walk.rest().front()))
            walk.refuse("the name of a table after '['");
}

std::string read_toml_text(const std::filesystem::path& path) {
    std::string text = read_text_file(path, ErrorKind::usage);
    check_toml(path.string(), text);
    return text;
}

}  // namespace eventide
