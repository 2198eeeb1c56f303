// When frames are asked for.
#include "pipeline/frame_clock.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <utility>

namespace eventide {
namespace {

__extension__ using Wide = __int128;

constexpr std::int64_t kUsPerSecond = 1'000'000;
constexpr std::int64_t kMaxPerSecond = 1'000'000;
constexpr std::size_t kMaxDigits = 12;  // of numerator and denominator: products fit 128 bits

[[noreturn]] void refuse(std::string_view text) {
    throw Error(ErrorKind::usage, "frame rate '" + std::string{text} +
                                      "': expected more than 0 and at most 1000000 frames per "
                                      "second, in digits, for example 120, 29.97 or 30000/1001");
}

std::int64_t digits(std::string_view part, std::string_view text) {
    const auto value = number_in<std::int64_t>(part);
    if (!value || part.size() > kMaxDigits || part.front() == '-') refuse(text);
    return *value;
}

FrameRate fraction(std::string_view text) {
    if (const auto slash = text.find('/'); slash != text.npos)
        return {digits(text.substr(0, slash), text), digits(text.substr(slash + 1), text)};
    const auto point = text.find('.');
    if (point == text.npos) return {digits(text, text), 1};
    const std::string_view decimals = text.substr(point + 1);
    if (decimals.size() > 6) refuse(text);
    std::int64_t scale = 1;
    for (std::size_t i = 0; i < decimals.size(); ++i) scale *= 10;
    const std::int64_t whole = point == 0 ? 0 : digits(text.substr(0, point), text);
    if (whole > kMaxPerSecond) refuse(text);
    return {whole * scale + digits(decimals, text), scale};
}

}  // namespace

FrameRate parse_frame_rate(std::string_view text) {
    const FrameRate rate = fraction(text);
    if (rate.frames < 1 || rate.seconds < 1) refuse(text);
    if (rate.frames / rate.seconds > kMaxPerSecond - (rate.frames % rate.seconds != 0))
        refuse(text);
    const std::int64_t common = std::gcd(rate.frames, rate.seconds);
    return {rate.frames / common, rate.seconds / common};
}

FrameRate slowed(const FrameRate& rate, double slow) {
    const Wide frames = Wide{rate.frames} * std::llround(slow * 1000),
               seconds = Wide{rate.seconds} * 1000;
    if (!rate.is_set()) return rate;
    const auto greatest_common = [](Wide a, Wide b) {
        while (b != 0) a = std::exchange(b, a % b);
        return a;
    };
    const Wide common = greatest_common(frames, seconds);
    if (frames > seconds * kMaxPerSecond || frames / common > INT64_MAX ||
        seconds / common > INT64_MAX) {
        std::array<char, 64> found{};
        std::snprintf(found.data(), found.size(), "%.6g x %.6g",
                      double(rate.frames) / double(rate.seconds), slow);
        throw Error(ErrorKind::usage,
                    "--fps with --slow: expected at most 1000000 frames per "
                    "second of sensor time, found " +
                        std::string{found.data()});
    }
    return {std::int64_t(frames / common), std::int64_t(seconds / common)};
}

SensorTime FrameClock::time_of(std::uint64_t index) const {
    const Wide us = Wide{index} * rate_.seconds * kUsPerSecond;
    return t0_ + SensorDuration{std::int64_t((2 * us + rate_.frames) / (2 * Wide{rate_.frames}))};
}

std::uint64_t FrameClock::count_until(SensorTime t) const {
    if (t < t0_) return 0;
    // Rounding moves a frame by half a microsecond at most, so this is one too many or right.
    const Wide us = (t - t0_).count();
    auto count = std::uint64_t((us + 1) * rate_.frames / (Wide{rate_.seconds} * kUsPerSecond)) + 1;
    while (count > 0 && time_of(count - 1) > t) --count;
    return count;
}

void FrameSchedule::open(Window window) {
    window_end_ = window.end;
    next_ = end_;
    if (!rate_.is_set()) {
        if (!from_ || window.end >= *from_) ++end_;
        return;
    }
    if (!clock_ && last_)
        clock_.emplace(rate_, std::max(FrameClock{rate_, *last_}.time_of(1),
                                       window.begin + SensorDuration{1}));
    if (!clock_) clock_.emplace(rate_, std::max(window.begin, from_.value_or(window.begin)));
    end_ = std::max(end_, base_ + clock_->count_until(window.end));
}

DueFrame FrameSchedule::next() {
    const std::uint64_t index = next_++;
    return {rate_.is_set() ? clock_->time_of(index - base_) : window_end_, index};
}

void FrameSchedule::change_rate(const FrameRate& rate) {
    // Frames since the rate or the sensor's clock began; of those before it `last_` is true
    // already.
    if (end_ > base_) last_ = clock_ ? clock_->time_of(end_ - 1 - base_) : window_end_;
    rate_ = rate;
    clock_.reset();
    base_ = next_ = end_;
}

void FrameSchedule::restart() {
    clock_.reset();
    last_.reset();
    from_.reset();  // a time of the old clock
    base_ = next_ = end_;
}

}  // namespace eventide
