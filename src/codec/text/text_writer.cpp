// Events -> lines of text.
#include "src/codec/append_text.h"
#include "src/codec/text/text.h"

#include <charconv>
#include <string>

namespace eventide {

namespace {

constexpr int kMaxDigits = 20;  // of 64 bits
constexpr int kMaxLine = 5 * kMaxDigits;

char* write_digits(char* p, std::uint64_t value) {
    return std::to_chars(p, p + kMaxDigits, value).ptr;
}

char* write_seconds(char* p, std::int64_t us) {
    // Unsigned, so that the most negative time has a magnitude too.
    const auto magnitude = us < 0 ? 0 - std::uint64_t(us) : std::uint64_t(us);
    if (us < 0) *p++ = '-';
    p = write_digits(p, magnitude / 1'000'000);
    *p++ = '.';
    auto decimals = std::uint32_t(magnitude % 1'000'000);
    for (int i = 5; i >= 0; --i, decimals /= 10) p[i] = char('0' + decimals % 10);
    return p + 6;
}

}  // namespace

void TextWriter::begin(const StreamHeader& header, std::vector<std::byte>& out) {
    if (header.width <= 0 || header.height <= 0) return;
    const std::string width = std::to_string(header.width), height = std::to_string(header.height);
    append_text(out, size_ == TextSize::in_a_comment ? "# geometry: " + width + "," + height + "\n"
                                                     : width + " " + height + "\n");
}

void TextWriter::write(const Batch& batch, std::vector<std::byte>& out) {
    char line[kMaxLine];
    for (const Event& event : batch.events) {
        char* p = write_seconds(line, to_us(event.t));
        *p++ = ' ';
        p = write_digits(p, event.x);
        *p++ = ' ';
        p = write_digits(p, event.y);
        *p++ = ' ';
        *p++ = event.polarity == Polarity::on ? '1' : '0';
        *p++ = '\n';
        append_text(out, {line, std::size_t(p - line)});
    }
}

}  // namespace eventide
