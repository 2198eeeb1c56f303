#include "src/codec/prophesee/evt_parser.h"

namespace eventide {
namespace {

std::uint32_t side(int px) {
    return px > 0 && px < 2048 ? std::uint32_t(px) : 2048;
}

}  // namespace

EvtParser::EvtParser(const Format& format, int width, int height, std::int64_t time_base_us)
    : width_(side(width)),
      height_(side(height)),
      time_base_us_(time_base_us),
      high_(format.high_bits, format.low_bits),
      format_(format) {}

void EvtParser::take_event(std::int64_t t_us, std::uint32_t x, std::uint32_t y, bool on,
                           Batch& into) {
    if (!high_.is_known()) return;  // taken up in the middle of the stream
    const Event event{from_us(t_us + time_base_us_), std::uint16_t(x), std::uint16_t(y),
                      Polarity(on)};
    if (x >= width_ || y >= height_) {
        damage_.count(DamageReason::out_of_range);
    } else if (t_us < last_event_us_ || high_.holds_later(event.t)) {
        damage_.count(DamageReason::time_backwards);
    } else if (!high_.is_sure()) {
        const std::size_t before = into.events.size();
        high_.hold(event, into, damage_);
        take_let_go(into, before);
    } else {
        last_event_us_ = t_us;
        into.events.push_back(event);
    }
}

void EvtParser::take_trigger(std::int64_t t_us, bool rising, std::uint8_t source, Batch& into) {
    if (!high_.is_known()) return;
    const Trigger found{from_us(t_us + time_base_us_),
                        rising ? Trigger::Kind::rising : Trigger::Kind::falling, source};
    if (high_.is_sure()) {
        into.triggers.push_back(found);
        move_clock(t_us);
        return;
    }
    const std::size_t before = into.events.size();
    high_.hold(found, into, damage_);
    take_let_go(into, before);
}

void EvtParser::take_let_go(const Batch& into, std::size_t before) {
    if (into.events.size() > before) last_event_us_ = to_us(into.events.back().t) - time_base_us_;
    move_clock(last_event_us_);
    if (high_.is_sure()) move_clock(told_us());
}

void EvtParser::take_let_go_by_high(Batch& into, std::size_t before) {
    take_let_go(into, before);
    if (last_event_us_ == kNoTime) seam_.see(high_.us() + time_base_us_, into);
}

void EvtParser::end(Batch& into) {
    const std::size_t before = into.events.size();
    high_.believe(into, damage_);
    take_let_go(into, before);
}

void EvtParser::begin_anew() {
    high_.gap(damage_);
    newest_us_ = last_event_us_ = kNoTime;
}

void EvtParser::begin_file(std::span<const std::byte> header) {
    seam_.begin_file(last_event_us_ == kNoTime ? kNoTime : last_event_us_ + time_base_us_);
    begin_anew();
    high_ = {format_.high_bits, format_.low_bits};
    is_of_other_format_ = is_of_other_format(header, format_.name);
    read_header(header);
}

void EvtParser::reopened() {
    resync();
    high_.go_on_by_host();
}

std::optional<SensorTime> EvtParser::clock() const {
    return newest_us_ == kNoTime ? std::nullopt
                                 : std::optional(from_us(newest_us_ + time_base_us_));
}

}  // namespace eventide
