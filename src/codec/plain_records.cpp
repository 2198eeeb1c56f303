// Data as records of 16 bytes, and back.
#include "src/codec/plain_records.h"

#include "src/core/bayer.h"
#include "src/core/byte_order.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <cstring>

namespace eventide {

namespace {

enum class Kind : std::uint8_t { none, event, image, imu, trigger, damage };

constexpr std::size_t kImageFields = 28;  // exposure's begin and end, x0, y0, colour filter
constexpr std::size_t kImuFields = 40;

struct Head {
    Kind kind = Kind::none;
    std::uint8_t small = 0;
    std::uint16_t first = 0, second = 0;
    std::int64_t t = 0;
};

void append(const Head& head, std::vector<std::byte>& out) {
    std::array<std::byte, 16> bytes{std::byte(head.kind), std::byte(head.small)};
    std::ranges::copy(little_bytes(head.first), bytes.begin() + 2);
    std::ranges::copy(little_bytes(head.second), bytes.begin() + 4);
    std::ranges::copy(little_bytes(head.t), bytes.begin() + 8);
    out.insert(out.end(), bytes.begin(), bytes.end());
}

void append(const ReferenceImage& image, std::vector<std::byte>& out) {
    const int width = image.pixels.width() / std::max(image.channels, 1);
    append(Head{Kind::image, std::uint8_t(image.channels), std::uint16_t(width),
                std::uint16_t(image.pixels.height()), to_us(image.t)},
           out);
    append_little(out, to_us(image.exposure_begin));
    append_little(out, to_us(image.exposure_end));
    append_little(out, std::int32_t(image.x0));
    append_little(out, std::int32_t(image.y0));
    append_little(out, number_of(image.filter));
    for (const std::uint16_t value : image.pixels.values()) append_little(out, value);
}

void append(const ImuSample& sample, std::vector<std::byte>& out) {
    append(Head{Kind::imu, 0, 0, 0, to_us(sample.t)}, out);
    for (const auto* axes : {&sample.acceleration_g, &sample.gyro_dps, &sample.magnetic_ut})
        for (const float value : *axes) append_little_float(out, value);
    append_little_float(out, sample.temperature_c);
}

}  // namespace

void append_plain_records(const Batch& batch, const Damage& found, std::vector<std::byte>& out) {
    out.reserve(out.size() + 16 * batch.events.size());
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        if (const std::uint64_t n = found[DamageReason(i)]; n > 0)
            append(Head{Kind::damage, std::uint8_t(i), 0, 0, std::int64_t(n)}, out);
    for (const Trigger& trigger : batch.triggers)
        append(Head{Kind::trigger, std::uint8_t(trigger.kind), trigger.source, 0, to_us(trigger.t)},
               out);
    for (const ImuSample& sample : batch.imu) append(sample, out);
    auto image = batch.images.begin();
    for (const Event& event : batch.events) {
        for (; image != batch.images.end() && image->t <= event.t; ++image) append(*image, out);
        append(Head{Kind::event, std::uint8_t(event.polarity), event.x, event.y, to_us(event.t)},
               out);
    }
    for (; image != batch.images.end(); ++image) append(*image, out);
}

void PlainRecordsParser::parse(std::span<const std::byte> bytes, Batch& into) {
    while (!bytes.empty()) {
        std::size_t taken = 0;
        if (rest_ == 0) {
            taken = take_head(bytes, into);
        } else {
            taken = std::min(rest_, bytes.size());
            payload_.insert(payload_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(taken));
            rest_ -= taken;
            if (rest_ == 0) end_payload(into);
        }
        bytes = bytes.subspan(taken);
    }
}

std::size_t PlainRecordsParser::take_head(std::span<const std::byte> bytes, Batch& into) {
    if (head_bytes_ == 0 && bytes.size() >= kHeadBytes) {
        take_record(bytes.data(), into);
        return kHeadBytes;
    }
    const std::size_t n = std::min(kHeadBytes - head_bytes_, bytes.size());
    std::copy_n(bytes.begin(), n, head_.begin() + std::ptrdiff_t(head_bytes_));
    head_bytes_ += n;
    if (head_bytes_ == kHeadBytes) {
        head_bytes_ = 0;
        take_record(head_.data(), into);
    }
    return n;
}

void PlainRecordsParser::take_record(const std::byte* head, Batch& into) {
    const auto small = std::to_integer<std::uint8_t>(head[1]);
    const auto t = load_little<std::int64_t>(head + 8);
    switch (Kind(head[0])) {
        case Kind::event:
            return take_event(head, into);
        case Kind::image:
            return begin_image(head);
        case Kind::imu:
            std::copy_n(head, kHeadBytes, head_.begin());
            rest_ = kImuFields;
            return;
        case Kind::trigger:
            if (small > std::uint8_t(Trigger::Kind::other)) break;
            tell(t);
            into.triggers.push_back(
                {from_us(t), Trigger::Kind(small), std::to_integer<std::uint8_t>(head[2])});
            return;
        case Kind::damage:
            if (small >= kDamageReasons) break;
            damage_.count(DamageReason(small), std::uint64_t(t));
            return;
        case Kind::none:
            break;
    }
    damage_.count(DamageReason::unknown_word);
}

void PlainRecordsParser::take_event(const std::byte* head, Batch& into) {
    const auto t = load_little<std::int64_t>(head + 8);
    const auto x = load_little<std::uint16_t>(head + 2), y = load_little<std::uint16_t>(head + 4);
    const bool on = head[1] != std::byte{0};
    if (validator_.is_plain(t) && validator_.is_inside(x, y)) {
        validator_.pass(t);
        into.events.push_back({from_us(t), x, y, Polarity(on)});
    } else {
        validator_.add(t, x, y, on, into, damage_);
    }
}

void PlainRecordsParser::begin_image(const std::byte* head) {
    const auto channels = std::to_integer<std::size_t>(head[1]);
    const std::size_t width = load_little<std::uint16_t>(head + 2),
                      height = load_little<std::uint16_t>(head + 4);
    const auto fits = [](std::size_t side) {
        return side > 0 && side <= std::size_t(kLargestSensorSide);
    };
    if ((channels != 1 && channels != 3 && channels != 4) || !fits(width) || !fits(height))
        return damage_.count(DamageReason::bad_length);
    std::copy_n(head, kHeadBytes, head_.begin());
    rest_ = kImageFields + 2 * width * height * channels;
}

void PlainRecordsParser::end_payload(Batch& into) {
    Kind(head_[0]) == Kind::image ? end_image(into) : end_imu(into);
    payload_.clear();
}

void PlainRecordsParser::end_image(Batch& into) {
    ReferenceImage image;
    image.t = from_us(load_little<std::int64_t>(head_.data() + 8));
    image.exposure_begin = from_us(load_little<std::int64_t>(payload_.data()));
    image.exposure_end = from_us(load_little<std::int64_t>(payload_.data() + 8));
    image.x0 = load_little<std::int32_t>(payload_.data() + 16);
    image.y0 = load_little<std::int32_t>(payload_.data() + 20);
    image.filter = colour_filter_of_number(load_little<std::uint32_t>(payload_.data() + 24))
                       .value_or(ColourFilter::none);
    image.channels = std::to_integer<int>(head_[1]);
    image.pixels =
        Array2<std::uint16_t>(load_little<std::uint16_t>(head_.data() + 4),
                              load_little<std::uint16_t>(head_.data() + 2) * image.channels);
    const std::byte* at = payload_.data() + kImageFields;
    for (std::uint16_t& value : image.pixels.values()) {
        value = load_little<std::uint16_t>(at);
        at += 2;
    }
    tell(to_us(image.t));
    into.add_image(std::move(image));
}

void PlainRecordsParser::end_imu(Batch& into) {
    ImuSample sample;
    sample.t = from_us(load_little<std::int64_t>(head_.data() + 8));
    const std::byte* at = payload_.data();
    const auto next = [&at] {
        const float value = load_little_float(at);
        at += 4;
        return value;
    };
    for (auto* axes : {&sample.acceleration_g, &sample.gyro_dps, &sample.magnetic_ut})
        for (float& value : *axes) value = next();
    sample.temperature_c = next();
    tell(to_us(sample.t));
    into.imu.push_back(sample);
}

void PlainRecordsParser::tell(std::int64_t t_us) {
    if (const auto newest = validator_.newest_us()) told_.tell_by_events(*newest);
    told_.tell(t_us);
    told_.end_packet();
}

void PlainRecordsParser::finish(Batch& into) {
    if (head_bytes_ > 0 || rest_ > 0) damage_.count(DamageReason::truncated);
    head_bytes_ = rest_ = 0;
    payload_.clear();
    validator_.finish(into, damage_);
    if (const auto newest = validator_.newest_us()) told_.tell_by_events(*newest);
    told_.finish();
}

void PlainRecordsParser::resync() {
    head_bytes_ = rest_ = 0;
    payload_.clear();
    validator_.resync(damage_);
    told_ = {};
}

std::optional<SensorTime> PlainRecordsParser::clock() const {
    const auto newest =
        std::max(validator_.newest_us(), told_.newest_us());  // none is less than any
    return newest ? std::optional(from_us(*newest)) : std::nullopt;
}

}  // namespace eventide
