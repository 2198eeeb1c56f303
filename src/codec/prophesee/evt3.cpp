// EVT3 words -> events: a short loop for the usual, one function for everything.
#include "src/codec/prophesee/evt3.h"

#include "src/core/byte_order.h"

#include <bit>

namespace eventide {

namespace {

enum Type : unsigned {
    address_y = 0x0,
    address_x = 0x2,
    vector_base_x = 0x3,
    vector_12 = 0x4,
    vector_8 = 0x5,
    time_low = 0x6,
    continued_4 = 0x7,
    time_high = 0x8,
    trigger = 0xA,
    others = 0xE,  // of the camera itself, and the ends of frames of some receivers
    continued_12 = 0xF
};

constexpr std::uint16_t kPadding = 0x9999;
constexpr unsigned kColumnBits = 0x7FF, kOnBit = 0x800, kTimeBits = 0xFFF;

}  // namespace

/// Rows, single events, vectors and times that grow, while nothing is wrong.
void Evt3Parser::take(std::span<const std::byte> words, Batch& into) {
    Event* const out = block_.data();
    const std::uint32_t width = width_, height = height_;
    std::int64_t t = t_us_;
    std::uint32_t y = y_, base_x = base_x_;
    bool base_on = base_on_, plain = plain_;
    std::size_t n = 0;
    const auto pass_on = [&] {
        if (n > 0) last_event_us_ = to_us(out[n - 1].t) - time_base_us_;
        block_.pass(n, into);
        n = 0;
    };
    const auto put_down = [&] {
        t_us_ = t, y_ = y, base_x_ = base_x, base_on_ = base_on;
        if (plain && t > newest_us_) newest_us_ = t;
    };
    const auto make = [&, base = time_base_us_](std::uint32_t x, bool on) {
        return Event{from_us(t + base), std::uint16_t(x), std::uint16_t(y), Polarity(on)};
    };
    const std::byte* const end = words.data() + words.size();
    for (const std::byte* at = words.data(); at != end; at += 2) {
        if (EventBlock::full(n)) pass_on();
        const auto word = load_little<std::uint16_t>(at);
        const unsigned type = word >> 12, x = word & kColumnBits;
        if (plain) {
            if (type == address_x && x < width) {
                out[n++] = make(x, (word & kOnBit) != 0);
                continue;
            }
            if (type == address_y && x < height) {
                y = x;
                continue;
            }
            if (type == time_low && (word & kTimeBits) >= (t & kTimeBits)) {
                t = (t & ~std::int64_t(kTimeBits)) | (word & kTimeBits);
                continue;
            }
            if (type == vector_base_x) {
                base_x = x;
                base_on = (word & kOnBit) != 0;
                continue;
            }
            if ((type == vector_12 || type == vector_8) && base_x + 12 <= width) {
                const unsigned bits = type == vector_12 ? 12 : 8;
                for (unsigned mask = word & ((1U << bits) - 1); mask != 0; mask &= mask - 1)
                    out[n++] = make(base_x + unsigned(std::countr_zero(mask)), base_on);
                base_x += bits;
                continue;
            }
        }
        pass_on();
        put_down();
        take_one(word, into);
        t = t_us_, y = y_, base_x = base_x_, base_on = base_on_, plain = plain_;
    }
    pass_on();
    put_down();
}

void Evt3Parser::take_one(std::uint16_t word, Batch& into) {
    const unsigned content = word & 0xFFF;
    switch (word >> 12) {
        case address_y:
            y_ = content & kColumnBits;
            break;
        case address_x:
            take_column(content & kColumnBits, (content & kOnBit) != 0, into);
            break;
        case vector_base_x:
            base_x_ = content & kColumnBits;
            base_on_ = (content & kOnBit) != 0;
            break;
        case vector_12:
            take_vector(content, 12, into);
            break;
        case vector_8:
            take_vector(content & 0xFF, 8, into);
            break;
        case time_low:
            t_us_ = high_.us() + content;
            if (high_.is_sure()) move_clock(t_us_);
            break;
        case time_high: {
            const std::int64_t high_us = high_.us();
            const bool first = !high_.is_known();
            const std::size_t before = into.events.size();
            high_.push(content, into, damage_);
            // The low bits follow in their own word and begin anew.
            if (first || high_.us() != high_us) t_us_ = high_.us();
            take_let_go_by_high(into, before);
            break;
        }
        case trigger:
            take_trigger(t_us_, (content & 1) != 0, std::uint8_t(content >> 8), into);
            break;
        case continued_4:
        case continued_12:
        case others:
            break;
        default:
            if (word != kPadding) damage_.count(DamageReason::unknown_word);
    }
    look();
}

void Evt3Parser::look() {
    plain_ = high_.is_sure() && y_ < height_ && t_us_ >= last_event_us_;
}

void Evt3Parser::take_column(unsigned x, bool on, Batch& into) {
    if (y_ != kNoRow) take_event(t_us_, x, y_, on, into);
}

void Evt3Parser::take_vector(unsigned mask, unsigned bits, Batch& into) {
    if (base_x_ == kNoColumn) return;
    for (; mask != 0; mask &= mask - 1)
        take_column(base_x_ + unsigned(std::countr_zero(mask)), base_on_, into);
    base_x_ = std::min(base_x_ + bits, kNoColumn - 1);
}

void Evt3Parser::end(Batch& into) {
    EvtParser::end(into);
    look();
}

void Evt3Parser::end_message(Batch& into) {
    end_words();
    const std::size_t before = into.events.size();
    high_.believe_first(into);
    take_let_go(into, before);
    look();
}

void Evt3Parser::begin_anew() {
    EvtParser::begin_anew();
    y_ = kNoRow;
    base_x_ = kNoColumn;
    look();
}

void Evt3Parser::read_header(std::span<const std::byte> header) {
    if (const auto found = find_evt_header(header)) time_base_us_ = found->time_base_us;
}

}  // namespace eventide
