#include "src/codec/inivation/davis.h"

#include "src/core/byte_order.h"

#include <algorithm>

namespace eventide {
namespace {

constexpr std::uint16_t kTimestampBit = 0x8000;
constexpr std::uint16_t kDataMask = 0x0FFF;

/// Bits 14-12 of a data word (A.9).
enum Code : std::uint16_t {
    special_code = 0,
    y_code,
    x_off_code,
    x_on_code,
    adc_code,
    misc8_code,
    misc10_code,
    wrap_code
};

}  // namespace

DavisParser::DavisParser(const DavisSensor& sensor)
    : sensor_(sensor), frame_(sensor), imu_(sensor) {
    kinds_[y_code] = {0, -1, 0, sensor.dvs_rows - 1};
    kinds_[x_off_code] = kinds_[x_on_code] = {0, 0, 1, sensor.dvs_columns - 1};
    for (std::size_t i = kTimestampBit >> 12; i < kinds_.size(); ++i)
        kinds_[i] = {-1, 0, 0, kDataMask};
}

void DavisParser::parse(std::span<const std::byte> bytes, Batch& into) {
    words_.feed(bytes, [&](std::span<const std::byte> whole) { parse_words(whole, into); });
}

void DavisParser::parse_words(std::span<const std::byte> bytes, Batch& into) {
    while (!bytes.empty()) {
        std::size_t done = 0;
        if (clock_.is_settled() && y_known_ && y_ < sensor_.dvs_rows) {
            const auto stretch = bytes.first(std::min(bytes.size(), 2 * kStretchWords));
            done = sensor_.dvs_swapped ? plain_words<true>(stretch, into)
                                       : plain_words<false>(stretch, into);
        }
        if (done == 0) {
            word(load_little<std::uint16_t>(bytes.data()), into);
            done = 2;
        }
        bytes = bytes.subspan(done);
    }
}

/// Timestamps, rows and events are all but a few of the words, in an order that no branch predictor
/// can guess: so each word is worked on as if it were all three, and masks keep what it really is.
/// Stops before the first word that is anything else, or bad; returns the bytes read.
template <bool kSwapped>
std::size_t DavisParser::plain_words(std::span<const std::byte> bytes, Batch& into) {
    const std::int64_t wrap_add = clock_.wrap_add();
    std::int64_t time = clock_.us(), y = y_;
    Event* event = found_.data();
    std::size_t at = 0;
    for (; at < bytes.size(); at += 2) {
        const std::uint16_t w = load_little<std::uint16_t>(&bytes[at]);
        const WordKind& is = kinds_[w >> 12];
        const std::int64_t data = w & kDataMask;
        const std::int64_t passed = (wrap_add + (w & ~kTimestampBit) - time) & is.time;
        if ((passed | (is.last - data)) < 0) break;
        time += passed;
        y ^= (y ^ data) & is.row;
        *event = {from_us(time), std::uint16_t(kSwapped ? y : data),
                  std::uint16_t(kSwapped ? data : y), Polarity((w >> 12) & 1)};
        event += is.event;
    }
    clock_.move_on(time);
    y_ = std::uint16_t(y);
    into.events.insert(into.events.end(), found_.data(), event);
    return at;
}

/// Any word.
void DavisParser::word(std::uint16_t w, Batch& into) {
    const std::uint16_t data = w & kDataMask;
    if ((w & kTimestampBit) != 0) {
        clock_.timestamp(std::uint16_t(w & ~kTimestampBit), damage_);
        return;
    }
    switch (w >> 12) {
        case special_code:
            return special(data, into);
        case y_code:
            y_ = data;
            y_known_ = true;
            return;
        case x_off_code:
            return event(data, Polarity::off, into);
        case x_on_code:
            return event(data, Polarity::on, into);
        case adc_code:
            return frame_.sample(data & 0x3FF, clock_.now());
        case misc8_code:
            return misc8(data);
        case misc10_code:
            if ((data >> 10) == 0) return;  // the exposure that the camera measured
            return damage_.count(DamageReason::unknown_word);
        default:  // wrap_code: there are no more
            return clock_.wrap(data, damage_);
    }
}

void DavisParser::misc8(std::uint16_t data) {
    const auto value = std::uint8_t(data & 0xFF);
    switch (data >> 8) {
        case 0:
            return imu_.byte(value);
        case 1:  // high and low bytes come in turn
        case 2:
            return frame_.roi_byte(value);
        case 3:
            return imu_.scale(value);
        default:
            return damage_.count(DamageReason::unknown_word);
    }
}

void DavisParser::event(std::uint16_t x, Polarity polarity, Batch& into) {
    if (!clock_.is_known() || !y_known_)
        return;  // after a loss, until the words it needs came again
    if (x >= sensor_.dvs_columns || y_ >= sensor_.dvs_rows)
        return damage_.count(DamageReason::out_of_range);
    into.events.push_back(sensor_.dvs_swapped ? Event{clock_.now(), y_, x, polarity}
                                              : Event{clock_.now(), x, y_, polarity});
}

void DavisParser::timestamp_reset(Batch& into) {
    clock_.reset(damage_);
    frame_.abandon();
    imu_.abandon();
    trigger(Trigger::Kind::timestamp_reset, 0, into);
}

void DavisParser::trigger(Trigger::Kind kind, std::uint8_t source, Batch& into) {
    if (clock_.is_known()) into.triggers.push_back({clock_.now(), kind, source});
}

void DavisParser::begin_frame(DavisFrameAssembler::Shutter shutter) {
    if (clock_.is_known()) note_loss(frame_.begin(shutter, clock_.now()));
}

/// Of an image or IMU sample that words are missing of.
void DavisParser::note_loss(bool is_lost) {
    if (is_lost) damage_.count(DamageReason::bad_record);
}

void DavisParser::special(std::uint16_t data, Batch& into) {
    using Frame = DavisFrameAssembler;
    constexpr std::uint8_t kInput = 0;
    const SensorTime now = clock_.now();
    switch (data) {
        case 0:
            return;
        case 1:
            return timestamp_reset(into);
        case 2:
            return trigger(Trigger::Kind::falling, kInput, into);
        case 3:
            return trigger(Trigger::Kind::rising, kInput, into);
        case 4:
            return trigger(Trigger::Kind::pulse, kInput, into);
        case 5:
            return note_loss(imu_.begin());
        case 7: {
            ImuSample sample;
            const auto end = imu_.end(now, sample);
            if (end == DavisImuAssembler::End::complete && clock_.is_known())
                into.imu.push_back(sample);
            return note_loss(end == DavisImuAssembler::End::incomplete);
        }
        case 8:
            return begin_frame(Frame::Shutter::global);
        case 9:
            return begin_frame(Frame::Shutter::rolling);
        case 10: {
            ReferenceImage image;
            const auto end = frame_.end(now, image);
            if (end == Frame::End::complete) into.add_image(std::move(image));
            return note_loss(end == Frame::End::incomplete);
        }
        case 11:
            return frame_.column_begin(Frame::Read::reset);
        case 12:
            return frame_.column_begin(Frame::Read::signal);
        case 13:
            return frame_.column_end();
        case 14:
            return frame_.exposure_begin(now);
        case 15:  // the first signal read says it
            return;
        case 16:
            return trigger(Trigger::Kind::falling, Trigger::kGenerator, into);
        case 17:
            return trigger(Trigger::Kind::rising, Trigger::kGenerator, into);
        default:
            return damage_.count(DamageReason::unknown_word);
    }
}

void DavisParser::finish(Batch&) {
    if (words_.is_half_read()) damage_.count(DamageReason::truncated);
    words_.drop();
}

void DavisParser::resync() {
    words_.drop();
    clock_.forget();
    y_known_ = false;
    frame_.abandon();
    imu_.abandon();
}

std::optional<SensorTime> DavisParser::clock() const {
    if (!clock_.is_known()) return std::nullopt;
    return clock_.now();
}

}  // namespace eventide
