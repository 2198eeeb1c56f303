// data -> RAW files of EVT3.
#include "src/codec/append_text.h"
#include "src/codec/prophesee/evt3.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

namespace eventide {

namespace {

constexpr std::int64_t kWrap = std::int64_t(1) << 24;                    // us
constexpr std::int64_t kLongestGap = std::int64_t(864'000) * 1'000'000;  // us, 10 days
// Cameras repeat the high time all the time; after a silence it grows in steps that are no leap.
constexpr std::int64_t kHighStep = 244;  // of 4096 us: 1 s
constexpr std::uint16_t kColumnLimit = 2048;
constexpr std::size_t kMostWaiting = std::size_t(1) << 16;  // triggers

Error cannot_hold(const std::string& what) {
    return Error(ErrorKind::usage, "EVT3 cannot hold " + what);
}

void append_word(std::vector<std::byte>& out, unsigned type, unsigned content) {
    append_little(out, std::uint16_t(type << 12 | content));
}

std::string on_one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
    return text;
}

/// How many events from the first on share its row, time and polarity, with columns that grow.
std::size_t run_length(std::span<const Event> events) {
    std::size_t n = 1;
    while (n < events.size() && events[n].t == events[0].t && events[n].y == events[0].y &&
           events[n].polarity == events[0].polarity && events[n].x > events[n - 1].x)
        ++n;
    return n;
}

}  // namespace

void Evt3Writer::begin(const StreamHeader& header, std::vector<std::byte>&) {
    // The header tells the first time, so it goes out with the first data.
    header_ = header;
}

void Evt3Writer::write_header(std::int64_t first_us, std::vector<std::byte>& out) {
    const std::int64_t wraps = first_us / kWrap - (first_us % kWrap < 0 ? 1 : 0);
    base_us_ = wraps * kWrap;
    std::string text = "% evt 3.0\n% format EVT3";
    if (header_.width > 0 && header_.height > 0) {
        const std::string width = std::to_string(header_.width);
        const std::string height = std::to_string(header_.height);
        text += ";height=" + height + ";width=" + width + "\n% geometry " + width + "x" + height;
    }
    text += "\n";
    if (!header_.sensor_name.empty())
        text += "% sensor_name " + on_one_line(header_.sensor_name) + "\n";
    if (!header_.serial.empty()) text += "% serial_number " + on_one_line(header_.serial) + "\n";
    if (base_us_ != 0) text += "% time_base_us " + std::to_string(base_us_) + "\n";
    append_text(out, text + "% end\n");
    header_written_ = true;
}

void Evt3Writer::time(SensorTime t, std::vector<std::byte>& out) {
    const std::int64_t us = to_us(t) - base_us_;
    if (time_written_ && us == t_us_) return;
    if (time_written_ && us < t_us_) throw cannot_hold("times that step back");
    if (time_written_ && us - t_us_ > kLongestGap) throw cannot_hold("a gap of more than 10 days");
    const std::int64_t high = us >> 12;
    if (!time_written_) high_ = high;
    bool high_told = time_written_ && high == high_;
    while (high - high_ > kHighStep) {
        high_ += kHighStep;
        append_word(out, 0x8, unsigned(high_ & 0xFFF));
    }
    high_ = high;
    if (!high_told) append_word(out, 0x8, unsigned(high & 0xFFF));
    append_word(out, 0x6, unsigned(us & 0xFFF));
    t_us_ = us;
    time_written_ = true;
}

bool evt3_holds(const Trigger& trigger) {
    const bool edge =
        trigger.kind == Trigger::Kind::rising || trigger.kind == Trigger::Kind::falling;
    return edge && trigger.source <= 15;
}

void Evt3Writer::trigger(const Trigger& trigger, std::vector<std::byte>& out) {
    time(time_written_ ? std::max(trigger.t, from_us(t_us_ + base_us_)) : trigger.t, out);
    append_word(out, 0xA,
                unsigned(trigger.source) << 8 | unsigned(trigger.kind == Trigger::Kind::rising));
}

/// Events of one row, time and polarity, columns growing.
void Evt3Writer::row(std::span<const Event> events, std::vector<std::byte>& out) {
    const unsigned on = events[0].polarity == Polarity::on ? 0x800U : 0U;
    int next_base = -1;
    while (!events.empty()) {
        const unsigned base = events[0].x & ~31U;
        std::uint32_t mask = 0;
        std::size_t n = 0;
        for (; n < events.size() && events[n].x < base + 32; ++n)
            mask |= 1U << (events[n].x - base);
        const bool goes_on = int(base) == next_base;
        if (n > (goes_on ? 3U : 4U)) {
            if (!goes_on) append_word(out, 0x3, base | on);
            append_word(out, 0x4, mask & 0xFFF);
            append_word(out, 0x4, mask >> 12 & 0xFFF);
            append_word(out, 0x5, mask >> 24);
            next_base = int(base) + 32;
        } else {
            for (const Event& event : events.first(n)) append_word(out, 0x2, event.x | on);
        }
        events = events.subspan(n);
    }
}

void Evt3Writer::write(const Batch& batch, std::vector<std::byte>& out) {
    if (!batch.images.empty()) throw cannot_hold("images");
    if (!batch.imu.empty()) throw cannot_hold("IMU samples");
    wait_for_events(batch.triggers);
    std::span<const Trigger> triggers(waiting_);
    std::span<const Event> events(batch.events);
    const auto is_due = [&] {
        return events.empty() ? triggers.size() > kMostWaiting
                              : !triggers.empty() && triggers[0].t <= events[0].t;
    };
    while (!events.empty() || is_due()) {
        if (!header_written_) write_header(to_us(is_due() ? triggers[0].t : events[0].t), out);
        if (is_due()) {
            trigger(triggers[0], out);
            triggers = triggers.subspan(1);
            continue;
        }
        const std::size_t n = run_length(events);
        for (const Event& event : {events[0], events[n - 1]})
            if (event.x >= kColumnLimit || event.y >= kColumnLimit)
                throw cannot_hold("an event at " + std::to_string(event.x) + ", " +
                                  std::to_string(event.y) + "; the largest coordinate is 2047");
        time(events[0].t, out);
        if (y_ != events[0].y) {
            y_ = events[0].y;
            append_word(out, 0x0, unsigned(y_));
        }
        row(events.first(n), out);
        events = events.subspan(n);
    }
    waiting_.erase(waiting_.begin(), waiting_.end() - std::ptrdiff_t(triggers.size()));
}

/// Events of their time, or before it, may come in the next batch.
void Evt3Writer::wait_for_events(std::span<const Trigger> triggers) {
    for (const Trigger& trigger : triggers)
        if (!evt3_holds(trigger))
            throw cannot_hold("a trigger of kind " + std::to_string(int(trigger.kind)) +
                              " from source " + std::to_string(trigger.source));
    waiting_.insert(waiting_.end(), triggers.begin(), triggers.end());
    std::ranges::stable_sort(waiting_, {}, &Trigger::t);
}

void Evt3Writer::finish(std::vector<std::byte>& out) {
    if (!header_written_) write_header(waiting_.empty() ? 0 : to_us(waiting_[0].t), out);
    for (const Trigger& each : std::exchange(waiting_, {})) trigger(each, out);
}

}  // namespace eventide
