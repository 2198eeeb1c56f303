// Times and their rate -> the unit that makes most sense of them.
#include "src/codec/text/text_time_unit.h"

#include "src/codec/text/text_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace eventide {
namespace {

constexpr std::size_t kFewestRows = 100;                           // that tell a rate
constexpr double kSlowest = 1e3, kFastest = 1e9, kDoubtful = 1e4;  // events/s
constexpr double kSparse = 100;                                    // events/s of a still scene
constexpr double kNanosecondsIn2001 = 1e18;
constexpr double kMicrosecondsIn2001 = 1e15, kMicrosecondsIn2096 = 4e15;

struct Unit {
    TextTimeUnit unit;
    const char* name;
    double seconds;
};
constexpr Unit kMicroseconds{TextTimeUnit::microseconds, "microseconds", 1e-6};
constexpr Unit kNanoseconds{TextTimeUnit::nanoseconds, "nanoseconds", 1e-9};
constexpr Unit kMilliseconds{TextTimeUnit::milliseconds, "milliseconds", 1e-3};
constexpr Unit kSeconds{TextTimeUnit::seconds, "seconds", 1};
/// The first that makes sense is meant.
constexpr std::array kByLikelihood{kMicroseconds, kNanoseconds, kMilliseconds, kSeconds};

struct Times {
    std::size_t count = 0;
    double least = 0, largest = 0;
    bool points = false;     ///< written with a decimal point or an exponent
    bool fractions = false;  ///< and not whole numbers all the same
    std::uint64_t tick = 0;  ///< what divides all steps from time to time; 0 where there is none

    bool tell_rate() const { return count >= kFewestRows && largest > least; }
    double rate(const Unit& unit) const {  ///< events/s
        return double(count) / ((largest - least) * unit.seconds);
    }
    bool make_sense(const Unit& unit) const {
        return rate(unit) >= kSlowest && rate(unit) <= kFastest;
    }
    bool are_sparse(const Unit& unit) const {
        return rate(unit) >= kSparse && rate(unit) < kSlowest;
    }
};

bool is_whole(Decimal value) {
    for (; value.exponent < 0 && value.digits % 10 == 0; ++value.exponent) value.digits /= 10;
    return value.exponent >= 0;
}

/// The first time is not of the clock of the others: a 0 before times since 1970, which readers
/// leave out as a leap.
bool is_apart(const std::vector<double>& times) {
    constexpr double kFar = 1e6;  // times what the others span
    const auto [least, largest] = std::ranges::minmax_element(times.begin() + 1, times.end());
    return std::abs(times[1] - times[0]) > kFar * (*largest - *least + 1);
}

Times read_times(std::span<const std::string_view> texts) {
    Times times;
    std::vector<double> all;
    std::uint64_t last = 0;
    for (const std::string_view text : texts) {
        const auto value = parse_decimal(text);
        if (!value || !scaled_integer(*value, 0)) continue;
        times.points |= value->fractional;
        times.fractions |= !is_whole(*value);
        const auto whole = std::uint64_t(*scaled_integer(*value, 0));
        const auto step = std::int64_t(whole - last);
        const auto size_of_step = step < 0 ? 0 - std::uint64_t(step) : std::uint64_t(step);
        if (!all.empty()) times.tick = std::gcd(times.tick, size_of_step);
        last = whole;
        const double size = double(value->digits) * std::pow(10.0, value->exponent);
        all.push_back(value->negative ? -size : size);
    }
    if (all.size() > 2 && is_apart(all)) all.erase(all.begin());
    times.count = all.size();
    if (all.empty()) return times;
    const auto [least, largest] = std::ranges::minmax_element(all);
    times.least = *least;
    times.largest = *largest;
    return times;
}

/// "870 events/s", "2.5e+06 events/s"
std::string rate_text(double rate) {
    char text[48];
    std::snprintf(text, sizeof text, rate >= 1 && rate < 1e4 ? "%.0f events/s" : "%.2g events/s",
                  rate);
    return text;
}

const char* doubt_of(double rate) {
    return rate > kFastest ? ", which no sensor sends" : ", which is slow for a sensor";
}

/// "times are whole numbers, taken for seconds: 2.5e+06 events/s; ..."
std::string remark_on(const std::string& what, const Times& times, const Unit& unit,
                      bool impossible) {
    return what + ", taken for " + unit.name + ": " + rate_text(times.rate(unit)) +
           (impossible ? doubt_of(times.rate(unit)) : "") + "; --input-time-unit states the unit";
}

/// Of whole numbers; null: none makes sense.
const Unit* likeliest_unit(const Times& times) {
    if (times.least >= kNanosecondsIn2001) return &kNanoseconds;
    if (times.least >= kMicrosecondsIn2001 && times.largest < kMicrosecondsIn2096)
        return &kMicroseconds;
    // Few events are likelier than another unit, down to where no sensor's noise alone is so
    // little; unless a sensor's microseconds can be seen in nanoseconds.
    if (times.are_sparse(kMicroseconds) && times.tick != 1000) return &kMicroseconds;
    for (const Unit& unit : kByLikelihood)
        if (times.make_sense(unit)) return &unit;
    return nullptr;
}

}  // namespace

TextTimeUnit guess_time_unit(std::span<const std::string_view> texts,
                             std::vector<std::string>& remarks) {
    const Times times = read_times(texts);
    if (times.fractions || (times.points && !times.tell_rate())) {
        if (times.tell_rate() && !times.make_sense(kSeconds))
            remarks.push_back(remark_on("times have a decimal point", times, kSeconds, true));
        return TextTimeUnit::seconds;
    }
    if (!times.tell_rate()) return TextTimeUnit::microseconds;
    const Unit* const likeliest = likeliest_unit(times);
    const Unit& unit = likeliest != nullptr ? *likeliest : kMicroseconds;
    if (likeliest == nullptr || times.points || unit.unit != TextTimeUnit::microseconds ||
        times.rate(unit) < kDoubtful)
        remarks.push_back(
            remark_on("times are whole numbers", times, unit, !times.make_sense(unit)));
    return unit.unit;
}

void doubt_time_unit(std::span<const std::string_view> texts, TextTimeUnit stated,
                     std::vector<std::string>& remarks) {
    const Times times = read_times(texts);
    const auto unit = std::ranges::find(kByLikelihood, stated, &Unit::unit);
    if (unit == kByLikelihood.end() || !times.tell_rate()) return;
    const double rate = times.rate(*unit);
    if (rate >= kSparse && rate <= kFastest) return;
    const Unit* const likeliest = times.fractions ? &kSeconds : likeliest_unit(times);
    const bool is_other = likeliest != nullptr && likeliest->unit != stated;
    remarks.push_back("in the stated unit of time these are " + rate_text(rate) + doubt_of(rate) +
                      (is_other ? std::string{"; taken for "} + likeliest->name + " they were " +
                                      rate_text(times.rate(*likeliest))
                                : "") +
                      "; --input-time-unit states another");
}

}  // namespace eventide
