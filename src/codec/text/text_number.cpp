// Decimal numbers in text, exactly.
#include "src/codec/text/text_number.h"

#include <limits>

namespace eventide {

namespace {

constexpr int kMaxDigits = int(kPowersOfTen.size()) - 1;  // any so many fit 64 bits
constexpr int kMaxExponent = 1000;

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

}  // namespace

std::optional<Decimal> parse_decimal(std::string_view text) {
    Decimal value;
    std::size_t i = 0;
    if (i < text.size() && (text[i] == '-' || text[i] == '+')) value.negative = text[i++] == '-';
    bool any = false, after_point = false;
    for (; i < text.size() && (is_digit(text[i]) || (text[i] == '.' && !after_point)); ++i) {
        if (text[i] == '.') {
            after_point = value.fractional = true;
            continue;
        }
        any = true;
        if (value.digits < kPowersOfTen[kMaxDigits - 1]) {
            value.digits = value.digits * 10 + std::uint64_t(text[i] - '0');
            value.exponent -= after_point;
        } else {
            value.exponent += !after_point;  // dropped
        }
        if (value.exponent > kMaxExponent || value.exponent < -kMaxExponent) return {};
    }
    if (!any) return {};
    if (i == text.size()) return value;

    if (text[i] != 'e' && text[i] != 'E') return {};
    value.fractional = true;
    bool down = false;
    if (++i < text.size() && (text[i] == '-' || text[i] == '+')) down = text[i++] == '-';
    if (i == text.size()) return {};
    int exponent = 0;
    for (; i < text.size(); ++i) {
        if (!is_digit(text[i]) || exponent > kMaxExponent) return {};
        exponent = exponent * 10 + (text[i] - '0');
    }
    value.exponent += down ? -exponent : exponent;
    return value;
}

std::optional<std::int64_t> scaled_integer(const Decimal& value, int shift) {
    constexpr auto kMax = std::uint64_t(std::numeric_limits<std::int64_t>::max());
    const int exponent = value.exponent + shift;
    std::uint64_t result = value.digits;
    if (exponent >= 0) {
        if (result != 0) {
            if (exponent > kMaxDigits) return {};
            const std::uint64_t power = kPowersOfTen[std::size_t(exponent)];
            if (result > kMax / power) return {};
            result *= power;
        }
    } else if (-exponent > kMaxDigits) {
        result = 0;
    } else {
        const std::uint64_t power = kPowersOfTen[std::size_t(-exponent)];
        const std::uint64_t rest = result % power;
        result = result / power + (rest >= power - rest ? 1 : 0);
    }
    if (result > kMax) return {};
    return value.negative ? -std::int64_t(result) : std::int64_t(result);
}

}  // namespace eventide
