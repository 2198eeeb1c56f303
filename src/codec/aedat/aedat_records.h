// The records of AEDAT 1 and 2, also of files that were joined one behind the other.
#pragma once

#include "src/codec/aedat/aedat_header.h"
#include "src/codec/whole_words.h"

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace eventide {

/// Hands out whole records. A header in the middle is passed over, wherever it begins: what follows
/// it are records of another file.
template <std::size_t kBytes>
class AedatRecords {
public:
    /// Calls use(const std::byte* record) for each record the bytes complete; joint() behind the
    /// last of a file, while is_half_read() says whether that was cut.
    template <typename Use, typename Joint>
    void feed(std::span<const std::byte> bytes, Use&& use, Joint&& joint) {
        while (!bytes.empty())
            bytes = in_header_ ? pass_header(bytes, use) : pass_records(bytes, use, joint);
    }
    /// The stream is over: what looked like the beginning of a header was none.
    template <typename Use, typename Joint>
    void finish(Use&& use, Joint&& joint) {
        give_back(use);
        joint();
        drop();
    }

    bool is_half_read() const { return words_.is_half_read(); }
    void drop() {
        words_.drop();
        line_.clear();
        kept_ = 0;
        in_header_ = false;
    }

private:
    static constexpr std::string_view kBegin = "#!AER-DAT";  // its first character once

    static std::span<const std::byte> bytes_of(std::string_view text) {
        return std::as_bytes(std::span(text));
    }
    static std::size_t next_begin(std::span<const std::byte> bytes, std::size_t from) {
        const void* found = std::memchr(&bytes[from], kBegin[0], bytes.size() - from);
        return found ? std::size_t(static_cast<const std::byte*>(found) - bytes.data())
                     : bytes.size();
    }

    template <typename Use>
    void take(std::span<const std::byte> bytes, Use& use) {
        words_.feed(bytes, [&](std::span<const std::byte> whole) {
            for (; !whole.empty(); whole = whole.subspan(kBytes)) use(whole.data());
        });
    }

    /// Up to the end of the bytes, or behind the beginning of a header.
    template <typename Use, typename Joint>
    std::span<const std::byte> pass_records(std::span<const std::byte> bytes, Use& use,
                                            Joint& joint) {
        std::size_t matched = kept_;
        for (std::size_t at = 0; at < bytes.size(); ++at) {
            if (matched == 0) at = next_begin(bytes, at);
            if (at == bytes.size()) break;
            if (bytes[at] != std::byte(kBegin[matched])) {
                give_back(use);
                matched = bytes[at] == std::byte(kBegin[0]) ? 1 : 0;
            } else if (++matched == kBegin.size()) {
                take(bytes.first(at + 1 + kept_ - matched), use);
                joint();
                drop();
                in_header_ = true;
                line_ = kBegin;
                return bytes.subspan(at + 1);
            }
        }
        take(bytes.first(bytes.size() + kept_ - matched), use);
        kept_ = matched;
        return {};
    }

    /// Line by line, up to what is none.
    template <typename Use>
    std::span<const std::byte> pass_header(std::span<const std::byte> bytes, Use& use) {
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            const char c = char(bytes[i]);
            if (c != '\n' && (line_.empty() ? c == '#' : is_aedat_text(c))) {
                line_ += c;
                continue;
            }
            const bool is_line = c == '\n' && !line_.empty();
            if (is_line && !is_last_aedat_line(line_)) {
                line_.clear();
                continue;
            }
            in_header_ = false;
            if (!is_line) take(bytes_of(line_), use);
            line_.clear();
            return bytes.subspan(i + (is_line ? 1 : 0));
        }
        return {};
    }

    template <typename Use>
    void give_back(Use& use) {
        take(bytes_of(kBegin.substr(0, kept_)), use);
        kept_ = 0;
    }

    WholeWords<kBytes> words_;
    std::size_t kept_ = 0;  ///< of kBegin, at the end of what was fed
    bool in_header_ = false;
    std::string line_;  ///< of a header, so far
};

}  // namespace eventide
