// Whole words out of RAW and DAT files that were joined one behind the other.
#pragma once

#include "src/codec/prophesee/evt_header.h"
#include "src/codec/whole_words.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace eventide {

/// As WholeWords, and a header in the middle, wherever it begins, is passed over: what follows it
/// are the words of another file.
template <std::size_t kBytes>
class JoinedWords {
public:
    using Bytes = std::span<const std::byte>;

    /// `behind_lines`: bytes of a header behind its lines.
    explicit JoinedWords(std::size_t behind_lines = 0) : behind_lines_(behind_lines) {}

    /// Calls use(span of whole words), and behind each header joint(the header), while
    /// is_half_read() says whether the file before it ended within a word.
    template <typename Use, typename Joint>
    void feed(Bytes bytes, Use&& use, Joint&& joint) {
        while (!bytes.empty())
            bytes = in_header_     ? pass_lines(bytes, use, joint)
                    : missing_ > 0 ? pass_behind_lines(bytes, joint)
                                   : pass_words(bytes, use);
    }
    /// The stream is over: what looked like the beginning of a header was none.
    template <typename Use, typename Joint>
    void finish(Use&& use, Joint&& joint) {
        if (in_header_ || missing_ > 0)
            end_header(joint);
        else
            words_.feed(bytes_of(std::exchange(line_, {})), use);
    }

    bool is_half_read() const { return words_.is_half_read(); }
    void drop() {
        words_.drop();
        header_.clear();
        line_.clear();
        in_header_ = false;
        missing_ = 0;
    }

private:
    /// How headers begin; words may look like "% " alone.
    static constexpr std::array<std::string_view, 16> kBegins{
        "% Data file ",     "% Date ",
        "% Version ",       "% camera_integrator_name ",
        "% date ",          "% endianness ",
        "% evt ",           "% firmware_version ",
        "% format ",        "% generation ",
        "% geometry ",      "% integrator_name ",
        "% plugin_name ",   "% sensor_generation ",
        "% serial_number ", "% system_ID "};

    static constexpr std::size_t kEnough = std::size_t{1} << 16;  ///< bytes of lines to be kept

    static Bytes bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }
    static bool begins_header(std::string_view text) {
        return std::ranges::any_of(kBegins, [&](auto begin) { return text == begin; });
    }
    static bool may_begin_header(std::string_view text) {
        return std::ranges::any_of(kBegins, [&](auto begin) { return begin.starts_with(text); });
    }
    /// As far as there are bytes. Most of what begins with % goes on with something else.
    static bool may_begin_header(Bytes bytes) {
        if (bytes.size() > 1 && bytes[1] != std::byte{' '}) return false;
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return std::ranges::any_of(kBegins, [&](auto begin) {
            return text.starts_with(begin) || begin.starts_with(text);
        });
    }
    static std::size_t next_percent(Bytes bytes, std::size_t from) {
        if (from >= bytes.size()) return bytes.size();
        const void* found = std::memchr(&bytes[from], '%', bytes.size() - from);
        return found ? std::size_t(static_cast<const std::byte*>(found) - bytes.data())
                     : bytes.size();
    }

    /// Up to the end of the bytes, or behind what a header begins with.
    template <typename Use>
    Bytes pass_words(Bytes bytes, Use& use) {
        if (line_.empty()) {
            std::size_t n = next_percent(bytes, 0);
            while (n < bytes.size() && !may_begin_header(bytes.subspan(n)))
                n = next_percent(bytes, n + 1);
            words_.feed(bytes.first(n), use);
            if (n == bytes.size()) return {};
            line_ = '%';
            return bytes.subspan(n + 1);
        }
        line_ += char(bytes[0]);
        in_header_ = begins_header(line_);
        if (may_begin_header(line_)) return bytes.subspan(1);
        line_.pop_back();  // what follows it may begin one
        words_.feed(bytes_of(std::exchange(line_, {})), use);
        return bytes;
    }

    /// Line by line, up to what is none.
    template <typename Use, typename Joint>
    Bytes pass_lines(Bytes bytes, Use& use, Joint& joint) {
        line_ += char(bytes[0]);
        bytes = bytes.subspan(1);
        if (!is_percent_line_so_far(line_)) {
            end_lines(std::exchange(line_, {}), use, joint);
        } else if (line_.ends_with('\n')) {
            if (header_.size() < kEnough) header_ += line_;
            if (is_last_percent_line(std::exchange(line_, {}))) end_lines("", use, joint);
        }
        return bytes;
    }

    /// `data`: what looked like one more line, so far.
    template <typename Use, typename Joint>
    void end_lines(const std::string& data, Use& use, Joint& joint) {
        in_header_ = false;
        missing_ = behind_lines_;
        words_.feed(pass_behind_lines(bytes_of(data), joint), use);
    }

    template <typename Joint>
    Bytes pass_behind_lines(Bytes bytes, Joint& joint) {
        const std::size_t n = std::min(missing_, bytes.size());
        header_.append(reinterpret_cast<const char*>(bytes.data()), n);
        missing_ -= n;
        if (missing_ == 0) end_header(joint);
        return bytes.subspan(n);
    }

    template <typename Joint>
    void end_header(Joint& joint) {
        const std::string header = std::exchange(header_, {});
        joint(bytes_of(header));
        drop();
    }

    std::size_t behind_lines_;
    WholeWords<kBytes> words_;
    std::string header_;  ///< so far, in whole lines, with what stands behind them
    std::string line_;    ///< of a header, so far, or what may begin one
    bool in_header_ = false;
    std::size_t missing_ = 0;  ///< bytes behind a header's lines
};

}  // namespace eventide
