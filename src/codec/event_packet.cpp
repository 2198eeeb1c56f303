// event_camera_msgs/EventPacket of ROS drivers.
#include "src/codec/event_packet.h"

#include "src/core/byte_order.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <utility>

namespace eventide {

namespace {

constexpr std::array kMagic{std::byte('E'), std::byte('V'), std::byte('P'), std::byte('K')};
/// In ns: so far inside what 64 bits hold that sums are, too.
constexpr std::uint64_t kLargestTime = std::uint64_t{1} << 62;

enum CompressedCode { time_high, time_low, address_x, address_y, vector_base_y, vector_8 };

}  // namespace

std::optional<EventPacketEncoding> event_packet_encoding(std::string_view name) {
    if (name == "evt3") return EventPacketEncoding::evt3;
    if (name == "libcaer") return EventPacketEncoding::libcaer;
    if (name == "libcaer_cmp") return EventPacketEncoding::libcaer_cmp;
    if (name == "mono") return EventPacketEncoding::mono;
    return std::nullopt;
}

void append_event_packet(const EventPacketHeader& header, std::span<const std::byte> payload,
                         std::vector<std::byte>& out) {
    out.insert(out.end(), kMagic.begin(), kMagic.end());
    append_little(out, std::uint32_t(payload.size()));
    append_little(out, header.time_base_ns);
    append_little(out, header.stamp_ns);
    out.insert(out.end(), payload.begin(), payload.end());
}

EventPacketParser::EventPacketParser(EventPacketEncoding encoding, int width, int height)
    : encoding_(encoding),
      validator_(std::uint64_t(width), std::uint64_t(height),
                 EventValidator::LeapEnds::with_next_packet),
      evt3_(width, height) {}

void EventPacketParser::parse(std::span<const std::byte> bytes, Batch& into) {
    while (!bytes.empty()) {
        std::size_t taken = 0;
        if (rest_ == 0) {
            taken = take_header(bytes);
        } else {
            taken = std::min(rest_, bytes.size());
            take_payload(bytes.first(taken), into);
            rest_ -= taken;
            if (rest_ == 0) end_packet(into);
        }
        bytes = bytes.subspan(taken);
    }
}

/// A byte at a time: after damage the next header may begin anywhere.
std::size_t EventPacketParser::take_header(std::span<const std::byte> bytes) {
    header_[header_bytes_++] = bytes.front();
    if (header_bytes_ <= kMagic.size()) {
        const bool fits = header_[header_bytes_ - 1] == kMagic[header_bytes_ - 1];
        if (fits) return 1;
        if (!lost_) damage_.count(DamageReason::bad_record);
        lost_ = true;
        // No part of the mark is its beginning, so only this byte can begin anew.
        header_bytes_ = header_[header_bytes_ - 1] == kMagic[0] ? 1 : 0;
        header_[0] = kMagic[0];
    } else if (header_bytes_ == EventPacketHeader::kBytes) {
        header_bytes_ = 0;
        begin_packet();
    }
    return 1;
}

void EventPacketParser::begin_packet() {
    const std::size_t length = load_little<std::uint32_t>(header_.data() + 4);
    const auto base = load_little<std::uint64_t>(header_.data() + 8);
    const auto stamp = load_little<std::uint64_t>(header_.data() + 16);
    if (length > kLargestPayload || base > kLargestTime || stamp > kLargestTime) {
        damage_.count(DamageReason::bad_length);
        lost_ = true;
        return;
    }
    lost_ = false;
    rest_ = length;
    base_ns_ = std::int64_t(base);
    stamp_us_ = std::int64_t(stamp) / 1000;
    high_ = low_ = 0;
    x_ = y_ = kNowhere;
}

void EventPacketParser::end_packet(Batch& into) {
    if (encoding_ == EventPacketEncoding::evt3) pass_evt3(into);
    if (words_.is_half_read() || events_.is_half_read()) damage_.count(DamageReason::truncated);
    words_.drop();
    events_.drop();
    validator_.end_packet();
}

void EventPacketParser::take_payload(std::span<const std::byte> bytes, Batch& into) {
    if (encoding_ == EventPacketEncoding::evt3) return evt3_.parse(bytes, evt3_batch_);
    if (encoding_ == EventPacketEncoding::libcaer_cmp) {
        words_.feed(bytes, [&](std::span<const std::byte> words) {
            for (std::size_t i = 0; i < words.size(); i += 2)
                take_compressed(load_little<std::uint16_t>(words.data() + i), into);
        });
        return;
    }
    events_.feed(bytes, [&](std::span<const std::byte> events) {
        for (std::size_t i = 0; i < events.size(); i += 8)
            if (encoding_ == EventPacketEncoding::libcaer)
                take_libcaer(events.data() + i, into);
            else
                take_mono(events.data() + i, into);
    });
}

void EventPacketParser::take_libcaer(const std::byte* event, Batch& into) {
    const auto data = load_little<std::uint32_t>(event);
    const auto stamp = std::int64_t(std::int32_t(load_little<std::uint32_t>(event + 4)));
    if ((data & 1) == 0) return;  // a filter of libcaer's took it out
    if (stamp < 0) {
        damage_.count(DamageReason::bad_record);
        return;
    }
    // Half the range: a smaller fall is no wrap but a time that goes back.
    constexpr std::int64_t kRange = std::int64_t{1} << 31;
    if (stamp < low_ - kRange / 2) ++high_;
    low_ = stamp;
    take_event(base_ns_ / 1000 + high_ * kRange + stamp, data >> 17, (data >> 2) & 0x7FFF,
               (data & 2) != 0, into);
}

void EventPacketParser::take_mono(const std::byte* event, Batch& into) {
    const auto word = load_little<std::uint64_t>(event);
    const std::int64_t t_us = (base_ns_ + std::int64_t(word & 0xFFFFFFFFU)) / 1000;
    shift_to_stamp(t_us);
    take_event(t_us + *shift_us_, (word >> 32) & 0xFFFF, (word >> 48) & 0x7FFF, (word >> 63) != 0,
               into);
}

void EventPacketParser::take_compressed(std::uint16_t word, Batch& into) {
    const unsigned content = word & 0xFFF;
    switch (word >> 12) {
        case time_high:
            return move_high(content);
        case time_low:
            return move_low(content);
        case address_x:
            x_ = content & 0x7FF;
            return;
        case address_y:
            return take_rows(1, content & 0x7FF, (content & 0x800) != 0, into);
        case vector_base_y:
            y_ = content & 0x7FF;
            on_ = (content & 0x800) != 0;
            return;
        case vector_8:
            if (y_ == kNowhere) return damage_.count(DamageReason::unknown_word);
            take_rows(content & 0xFF, y_, on_, into);
            y_ = std::min(y_ + 8, kNowhere - 8);
            return;
        default:
            damage_.count(DamageReason::unknown_word);
    }
}

/// libcaer_driver keeps four of the twelve bits (it has them in 16 bits, the low ones zero), so
/// that they wrap after 65 ms: what they say is taken for the next time they can mean.
void EventPacketParser::move_high(std::int64_t value) {
    const std::int64_t range = value < 16 ? 16 : 4096;
    high_ += (value - high_ % range + range) % range;
    low_ = 0;
}

/// It does not send the high bits where they change between two of the packets that it joins.
void EventPacketParser::move_low(std::int64_t value) {
    if (value < low_) ++high_;
    low_ = value;
}

void EventPacketParser::take_rows(unsigned mask, unsigned y, bool on, Batch& into) {
    if (x_ == kNowhere) return damage_.count(DamageReason::unknown_word);
    const std::int64_t t_us = base_ns_ / 1000 + high_ * 4096 + low_;
    for (; mask != 0; mask &= mask - 1)
        take_event(t_us, x_, y + unsigned(std::countr_zero(mask)), on, into);
}

/// The packet's first sensor time is at its stamp, unless a shift is known that says nearly so.
void EventPacketParser::shift_to_stamp(std::int64_t t_us) {
    if (shift_us_ && !after_gap_) return;
    const std::int64_t shift = stamp_us_ - t_us;
    if (!shift_us_ || std::abs(shift - *shift_us_) > kMaxShift.count()) shift_us_ = shift;
}

/// A whole packet's, as its first time may come after events of the row and time before.
void EventPacketParser::pass_evt3(Batch& into) {
    evt3_.end_message(evt3_batch_);
    const Damage now = evt3_.damaged();
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        damage_.count(DamageReason(i), now[DamageReason(i)] - evt3_damage_[DamageReason(i)]);
    evt3_damage_ = now;
    const auto clock = evt3_.clock();
    if (!clock) return;
    const auto& events = evt3_batch_.events;
    const auto& triggers = evt3_batch_.triggers;
    SensorTime first = *clock;
    if (!events.empty()) first = std::min(first, events.front().t);
    if (!triggers.empty()) first = std::min(first, triggers.front().t);
    shift_to_stamp(to_us(first));
    const SensorDuration shift{*shift_us_};
    begin_anew_after_gap(to_us(first + shift), into);
    for (Event event : events) {
        event.t += shift;
        into.events.push_back(event);
    }
    for (Trigger trigger : triggers) {
        trigger.t += shift;
        into.triggers.push_back(trigger);
    }
    newest_us_ = std::max(newest_us_, to_us(*clock + shift));
    if (!events.empty()) last_event_us_ = to_us(events.back().t + shift);
    evt3_batch_.clear();
}

void EventPacketParser::begin_anew_after_gap(std::int64_t t_us, Batch& into) {
    if (!std::exchange(after_gap_, false) || t_us >= last_event_us_) return;
    validator_.finish(into, damage_);
    validator_.resync(damage_);
    into.triggers.push_back({from_us(t_us), Trigger::Kind::timestamp_reset, 0});
    newest_us_ = last_event_us_ = t_us;
}

void EventPacketParser::take_event(std::int64_t t_us, unsigned x, unsigned y, bool on,
                                   Batch& into) {
    if (validator_.is_inside(x, y)) {
        begin_anew_after_gap(t_us, into);
        if (!validator_.newest_us()) validator_.pass(t_us);  // a camera's first event need not wait
    }
    validator_.add(t_us, x, y, on, into, damage_);
    note_newest();
}

void EventPacketParser::note_newest() {
    if (!validator_.newest_us()) return;
    last_event_us_ = *validator_.newest_us();
    newest_us_ = std::max(newest_us_, last_event_us_);
}

void EventPacketParser::finish(Batch& into) {
    if (rest_ > 0 || (header_bytes_ > 0 && !lost_)) damage_.count(DamageReason::truncated);
    if (encoding_ == EventPacketEncoding::evt3) {
        evt3_.finish(evt3_batch_);
        pass_evt3(into);
    }
    validator_.finish(into, damage_);
    note_newest();
    drop();
}

void EventPacketParser::resync() {
    drop();
    evt3_.resync();
    evt3_.parse({}, evt3_batch_);  // events of a packet whose rest is lost go with it
    evt3_batch_.clear();
    after_gap_ = true;
}

void EventPacketParser::drop() {
    rest_ = header_bytes_ = 0;
    lost_ = false;
    words_.drop();
    events_.drop();
}

std::optional<SensorTime> EventPacketParser::clock() const {
    return newest_us_ == kNoTime ? std::nullopt : std::optional(from_us(newest_us_));
}

}  // namespace eventide
