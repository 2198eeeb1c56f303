// DAT records -> events or triggers.
#include "src/codec/prophesee/dat.h"

#include "src/codec/nearest_time.h"
#include "src/codec/prophesee/evt_header.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <string>

namespace eventide {

namespace {

struct Place {
    std::uint32_t x, y;
    bool on;
};

// Version 2: x 14 bits, y 14 bits, polarity 4 bits; version 1: 9, 8, 1.
template <bool kVersion1>
Place place_of(std::uint32_t word) {
    if constexpr (kVersion1) return {word & 0x1FF, word >> 9 & 0xFF, (word >> 17 & 1) != 0};
    return {word & 0x3FFF, word >> 14 & 0x3FFF, (word >> 28 & 0xF) != 0};
}

std::uint32_t side(int px, std::uint32_t most) {
    return px > 0 ? std::min(std::uint32_t(px), most) : most;
}

int number(std::string_view text) {
    const int value = take_number<int>(text).value_or(0);
    return value > 0 && value <= 16384 ? value : 0;
}

}  // namespace

std::optional<DatHeader> find_dat_header(std::span<const std::byte> first_bytes) {
    const PercentLines lines = read_percent_lines(first_bytes);
    if (lines.bytes == 0 || lines.bytes + 2 > first_bytes.size()) return {};
    const auto type = std::to_integer<int>(first_bytes[lines.bytes]);
    const auto bytes = std::to_integer<int>(first_bytes[lines.bytes + 1]);
    if ((type != 0x00 && type != 0x0C && type != 0x0E) || bytes != 8) return {};
    if (!lines.value("evt").empty() || !lines.value("format").empty()) return {};
    DatHeader header;
    header.stream.format = "dat";
    header.stream.data_offset = lines.bytes + 2;
    header.stream.width = number(lines.value("Width"));
    header.stream.height = number(lines.value("Height"));
    header.stream.source_text = lines.value("Data");
    const bool version_1 = type == 0x00 && lines.value("Version") != "2";
    header.record = type == 0x0E ? DatHeader::Record::triggers
                    : version_1  ? DatHeader::Record::events_v1
                                 : DatHeader::Record::events_v2;
    return header;
}

DatHeader read_dat_header(std::span<const std::byte> first_bytes) {
    const auto header = find_dat_header(first_bytes);
    if (!header)
        throw Error(ErrorKind::input,
                    "DAT header: expected lines of \"% ...\", then a record type 0, 12 or 14 and a "
                    "record size of 8, found something else");
    return *header;
}

DatParser::DatParser(DatHeader::Record record, int width, int height)
    : record_(record),
      validator_(side(width, record == DatHeader::Record::events_v1 ? 512 : 16384),
                 side(height, record == DatHeader::Record::events_v1 ? 256 : 16384)) {}

void DatParser::parse(std::span<const std::byte> bytes, Batch& into) {
    words_.feed(
        bytes, [&](auto records) { take(records, into); },
        [&](auto header) {
            end_file(into);
            begin_file(header);
        });
}

/// No time lies before 0: there the stamp itself is meant, and the one before it lied.
std::int64_t DatParser::unwrapped(std::uint32_t stamp, std::int64_t near_us) {
    const std::int64_t t = nearest_time(stamp, near_us);
    return t < 0 ? std::int64_t(stamp) : t;
}

void DatParser::take(std::span<const std::byte> records, Batch& into) {
    if (is_of_other_format_) return damage_.count(DamageReason::unknown_word, records.size() / 8);
    Event* const out = block_.data();
    const bool version_1 = record_ == DatHeader::Record::events_v1;
    std::size_t n = 0;
    for (; !records.empty(); records = records.subspan(8)) {
        const auto stamp = load_little<std::uint32_t>(records.data());
        const auto word = load_little<std::uint32_t>(records.data() + 4);
        if (record_ == DatHeader::Record::triggers) {
            take_trigger(stamp, word, into);
            continue;
        }
        if (EventBlock::full(n)) {
            block_.pass(n, into);
            n = 0;
        }
        const Place at = version_1 ? place_of<true>(word) : place_of<false>(word);
        const std::int64_t t = unwrapped(stamp, validator_.newest_us().value_or(stamp));
        if (validator_.is_plain(t) && validator_.is_inside(at.x, at.y)) {
            out[n++] = {from_us(t), std::uint16_t(at.x), std::uint16_t(at.y), Polarity(at.on)};
            validator_.pass(t);
            continue;
        }
        block_.pass(n, into);
        n = 0;
        seam_.see(t, into);
        const std::size_t before = into.events.size();
        validator_.add(t, at.x, at.y, at.on, into, damage_);
        if (into.events.size() > before) seam_.end();
    }
    block_.pass(n, into);
}

/// Value in bit 0, number of the input in bits 12-8. The first one, and one after a long step,
/// waits for the next, which lies before it where its time is wrong.
void DatParser::take_trigger(std::uint32_t stamp, std::uint32_t word, Batch& into) {
    const std::int64_t near_us = last_trigger_us_ != kNoTime ? last_trigger_us_
                                 : held_trigger_             ? to_us(held_trigger_->t)
                                                             : stamp;
    const std::int64_t t = unwrapped(stamp, near_us);
    seam_.see(t, into);
    if (last_trigger_us_ != kNoTime && t < last_trigger_us_)
        return damage_.count(DamageReason::time_backwards);
    if (held_trigger_ && t < to_us(held_trigger_->t)) {
        damage_.count(DamageReason::bad_record);
        held_trigger_.reset();
    }
    let_trigger_go(into);
    held_trigger_ = {from_us(t), (word & 1) != 0 ? Trigger::Kind::rising : Trigger::Kind::falling,
                     std::uint8_t(word >> 8 & 0x1F)};
    const bool is_plain =
        last_trigger_us_ != kNoTime && t - last_trigger_us_ <= EventValidator::kLongestStep;
    if (is_plain) let_trigger_go(into);
}

void DatParser::let_trigger_go(Batch& into) {
    if (!held_trigger_) return;
    last_trigger_us_ = to_us(held_trigger_->t);
    into.triggers.push_back(*held_trigger_);
    seam_.end();
    held_trigger_.reset();
}

void DatParser::finish(Batch& into) {
    words_.finish([&](auto records) { take(records, into); }, [&](auto) { end_file(into); });
    end_file(into);
}

void DatParser::end_file(Batch& into) {
    if (words_.is_half_read()) damage_.count(DamageReason::truncated);
    words_.drop();
    validator_.finish(into, damage_);
    let_trigger_go(into);
}

void DatParser::begin_file(std::span<const std::byte> header) {
    const auto last = clock();
    resync();
    if (last) seam_.begin_file(to_us(*last));
    const auto found = find_dat_header(header);
    is_of_other_format_ = !found;
    if (found) record_ = found->record;
}

void DatParser::resync() {
    words_.drop();
    validator_.resync(damage_);
    held_trigger_.reset();
    last_trigger_us_ = kNoTime;
}

std::optional<SensorTime> DatParser::clock() const {
    if (const auto newest = validator_.newest_us()) return from_us(*newest);
    return last_trigger_us_ == kNoTime ? std::nullopt : std::optional(from_us(last_trigger_us_));
}

}  // namespace eventide
