// EVT2 and EVT2.1 words -> events: a short loop for events, one function for all else.
#include "src/codec/prophesee/evt2.h"

#include "src/core/byte_order.h"

#include <bit>

namespace eventide {

namespace {

enum Type : unsigned {
    cd_off = 0x0,
    cd_on = 0x1,
    time_high = 0x8,
    trigger = 0xA,
    others = 0xE,
    continued = 0xF
};

constexpr std::uint32_t kPadding = 0x99999999;

constexpr std::uint32_t x_of(std::uint32_t word) {
    return word >> 11 & 0x7FF;
}
constexpr std::uint32_t y_of(std::uint32_t word) {
    return word & 0x7FF;
}
constexpr std::int64_t low_time_of(std::uint32_t word) {
    return word >> 22 & 0x3F;
}

}  // namespace

void Evt2Base::take_other(std::uint32_t upper, bool is_padding, Batch& into) {
    switch (upper >> 28) {
        case time_high: {
            const std::size_t before = into.events.size();
            high_.push(upper & 0x0FFFFFFF, into, damage_);
            take_let_go_by_high(into, before);
            break;
        }
        case trigger:
            take_trigger(high_.us() + low_time_of(upper), (upper & 1) != 0,
                         std::uint8_t(upper >> 8 & 0x1F), into);
            break;
        case others:
        case continued:
            break;
        default:
            if (!is_padding) damage_.count(DamageReason::unknown_word);
    }
}

void Evt2Parser::take(std::span<const std::byte> words, Batch& into) {
    Event* const out = block_.data();
    const std::uint32_t width = width_, height = height_;
    std::int64_t high_us = high_.us(), last_us = last_event_us_;
    bool sure = high_.is_sure();
    std::size_t n = 0;
    const auto pass_on = [&] {
        block_.pass(n, into);
        n = 0;
    };
    const std::byte* const end = words.data() + words.size();
    for (const std::byte* at = words.data(); at != end; at += 4) {
        if (EventBlock::full(n)) pass_on();
        const auto word = load_little<std::uint32_t>(at);
        const std::uint32_t x = x_of(word), y = y_of(word);
        const std::int64_t t = high_us + low_time_of(word);
        const bool is_event = word >> 28 <= cd_on;
        if (is_event && sure && x < width && y < height && t >= last_us) {
            out[n++] = {from_us(t), std::uint16_t(x), std::uint16_t(y), Polarity(word >> 28)};
            last_us = t;
            continue;
        }
        pass_on();
        last_event_us_ = last_us;
        if (is_event)
            take_event(t, x, y, word >> 28 == cd_on, into);
        else
            take_other(word, word == kPadding, into);
        last_us = last_event_us_;
        high_us = high_.us();
        sure = high_.is_sure();
    }
    pass_on();
    last_event_us_ = last_us;
    move_clock(last_us);
}

Evt21Parser::Order Evt21Parser::order_of(const EvtHeader& header) {
    return header.halves_swapped ? Order::upper_half_first : Order::lower_half_first;
}

void Evt21Parser::read_header(std::span<const std::byte> header) {
    const auto found = find_evt_header(header);
    if (found && found->stream.format == "evt21") order_ = order_of(*found);
}

void Evt21Parser::take(std::span<const std::byte> words, Batch& into) {
    Event* const out = block_.data();
    const std::uint32_t width = width_, height = height_;
    const std::size_t upper_at = order_ == Order::upper_half_first ? 0 : 4;
    std::size_t n = 0;
    const auto pass_on = [&] {
        block_.pass(n, into);
        n = 0;
    };
    const std::byte* const end = words.data() + words.size();
    for (const std::byte* at = words.data(); at != end; at += 8) {
        if (EventBlock::full(n)) pass_on();
        const auto upper = load_little<std::uint32_t>(at + upper_at);
        auto mask = load_little<std::uint32_t>(at + 4 - upper_at);
        const std::uint32_t x = x_of(upper), y = y_of(upper);
        if (upper >> 28 > cd_on) {
            pass_on();
            take_other(upper, upper == kPadding && mask == kPadding, into);
            continue;
        }
        const std::int64_t t = high_.us() + low_time_of(upper);
        const bool on = upper >> 28 == cd_on;
        if (high_.is_sure() && x + 32 <= width && y < height && t >= last_event_us_) {
            if (mask != 0) last_event_us_ = t;
            for (; mask != 0; mask &= mask - 1)
                out[n++] = {from_us(t), std::uint16_t(x + std::uint32_t(std::countr_zero(mask))),
                            std::uint16_t(y), Polarity(on)};
            continue;
        }
        pass_on();
        for (; mask != 0; mask &= mask - 1)
            take_event(t, x + std::uint32_t(std::countr_zero(mask)), y, on, into);
    }
    pass_on();
    move_clock(last_event_us_);
}

}  // namespace eventide
