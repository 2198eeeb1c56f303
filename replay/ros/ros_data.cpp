// Fields of messages, in ROS 1's serialisation and in CDR.
#include "replay/ros/ros_data.h"

#include "replay/ros/ros_image.h"
#include "src/core/sensor_limits.h"
#include "src/io/bag_records.h"

#include <utility>

namespace eventide {

namespace {

std::int64_t ns_of(std::int64_t s, std::uint32_t ns) {
    return s * 1'000'000'000 + std::int64_t{ns};
}

SensorTime rounded(std::int64_t ns) {
    return from_us((ns >= 0 ? ns + 500 : ns - 499) / 1000);
}

/// ROS 1: no gaps; a header has a number first.
class Ros1Reader : public BlockReader {
public:
    using BlockReader::BlockReader;
    std::int64_t ns() {
        const auto s = number<std::uint32_t>();
        return ns_of(std::int64_t{s}, number<std::uint32_t>());
    }
    std::int64_t header() {
        number<std::uint32_t>();
        const std::int64_t stamp = ns();
        block();
        return stamp;
    }
    std::string_view text() { return text_of(block()); }
};

/// CDR: numbers lie at multiples of their size, counted from behind the first four bytes. Of both
/// byte orders only the usual one, little endian, is read.
class CdrReader {
public:
    explicit CdrReader(std::span<const std::byte> bytes)
        : bytes_(bytes), at_(4), good_(bytes.size() >= 4 && bytes[1] == std::byte{1}) {}

    template <typename T>
    T number() {
        at_ = 4 + (at_ - 4 + sizeof(T) - 1) / sizeof(T) * sizeof(T);
        const auto bytes = take(sizeof(T));
        return bytes.empty() ? T{} : load_little<T>(bytes.data());
    }
    std::span<const std::byte> take(std::size_t n) {
        good_ = good_ && at_ <= bytes_.size() && n <= bytes_.size() - at_;
        if (!good_) return {};
        at_ += n;
        return bytes_.subspan(at_ - n, n);
    }
    std::span<const std::byte> block() { return take(number<std::uint32_t>()); }
    /// Its length counts a zero at the end.
    std::string_view text() {
        const std::string_view text = text_of(block());
        return text.substr(0, text.find('\0'));
    }
    std::int64_t ns() {
        const auto s = number<std::int32_t>();
        return ns_of(std::int64_t{s}, number<std::uint32_t>());
    }
    std::int64_t header() {
        const std::int64_t stamp = ns();
        text();
        return stamp;
    }
    bool good() const { return good_; }

private:
    std::span<const std::byte> bytes_;
    std::size_t at_;
    bool good_;
};

bool is_size(std::uint32_t width, std::uint32_t height) {
    constexpr auto kLargest = std::uint32_t(kLargestSensorSide);
    return width > 0 && height > 0 && width <= kLargest && height <= kLargest;
}

/// The events of a message follow; x, y, time, polarity.
struct EventArrayHead {
    std::uint32_t width = 0, height = 0, count = 0;
};
template <typename Reader>
EventArrayHead read_event_array_head(Reader& reader) {
    reader.header();
    EventArrayHead head;
    head.height = reader.template number<std::uint32_t>();
    head.width = reader.template number<std::uint32_t>();
    head.count = reader.template number<std::uint32_t>();
    return head;
}

template <typename Reader>
std::optional<SensorTime> first_time_with(Reader reader) {
    if (read_event_array_head(reader).count == 0) return {};
    reader.template number<std::uint16_t>();
    reader.template number<std::uint16_t>();
    const std::int64_t t = reader.ns();
    return reader.good() ? std::optional(rounded(t)) : std::nullopt;
}

template <typename Reader>
std::optional<RosImageSize> image_size_with(Reader reader) {
    reader.header();
    const auto height = reader.template number<std::uint32_t>(),
               width = reader.template number<std::uint32_t>();
    if (!reader.good() || !is_size(width, height)) return {};
    return RosImageSize{int(width), int(height)};
}

}  // namespace

RosKind ros_kind(std::string_view type) {
    const std::size_t slash = type.find('/'), last = type.rfind('/');
    if (slash == type.npos) return RosKind::other;
    const std::string_view package = type.substr(0, slash), name = type.substr(last + 1);
    if (name == "EventArray" && (package == "dvs_msgs" || package == "prophesee_event_msgs"))
        return RosKind::events;
    if (package == "event_camera_msgs" && name == "EventPacket") return RosKind::packets;
    // What EventPacket was called before.
    if (package == "event_array_msgs" && name == "EventArray") return RosKind::packets;
    if (package == "sensor_msgs" && name == "Image") return RosKind::images;
    return RosKind::other;
}

bool RosData::take(RosForm form, std::span<const std::byte> message, Batch& into, Damage& damage) {
    const bool good = form.wire == RosWire::ros1
                          ? take_with(Ros1Reader{message}, form.kind, into, damage)
                          : take_with(CdrReader{message}, form.kind, into, damage);
    if (!good) damage.count(DamageReason::bad_record);
    return good;
}

template <typename Reader>
bool RosData::take_with(Reader reader, RosKind kind, Batch& into, Damage& damage) {
    switch (kind) {
        case RosKind::events:
            return take_events(reader, into, damage);
        case RosKind::packets:
            return take_packet(reader, into, damage);
        case RosKind::images:
            return take_image(reader, into);
        case RosKind::other:
            break;
    }
    return true;
}

std::optional<SensorTime> first_time(RosWire wire, std::span<const std::byte> message) {
    return wire == RosWire::ros1 ? first_time_with(Ros1Reader{message})
                                 : first_time_with(CdrReader{message});
}

std::optional<RosImageSize> image_size(RosWire wire, std::span<const std::byte> message) {
    return wire == RosWire::ros1 ? image_size_with(Ros1Reader{message})
                                 : image_size_with(CdrReader{message});
}

bool RosData::take_size(std::uint32_t width, std::uint32_t height) {
    if (!is_size(width, height)) return false;
    if (width_ == 0) {
        width_ = int(width);
        height_ = int(height);
    }
    return int(width) == width_ && int(height) == height_;
}

template <typename Reader>
bool RosData::take_events(Reader& reader, Batch& into, Damage& damage) {
    const EventArrayHead head = read_event_array_head(reader);
    if (!reader.good() || !take_size(head.width, head.height)) return false;
    const std::size_t before = into.events.size();
    for (std::uint32_t i = 0; i < head.count && reader.good(); ++i) {
        Event event;
        event.x = reader.template number<std::uint16_t>();
        event.y = reader.template number<std::uint16_t>();
        event.t = rounded(reader.ns());
        event.polarity = Polarity(reader.template number<std::uint8_t>() != 0);
        if (!reader.good()) break;
        if (event.x < head.width && event.y < head.height)
            into.events.push_back(event);
        else
            damage.count(DamageReason::out_of_range);
    }
    if (!reader.good()) into.events.resize(before);
    return reader.good();
}

template <typename Reader>
bool RosData::take_packet(Reader& reader, Batch& into, Damage& damage) {
    EventPacketHeader header;
    header.stamp_ns = reader.header();
    const auto height = reader.template number<std::uint32_t>(),
               width = reader.template number<std::uint32_t>();
    const auto sequence = reader.template number<std::uint64_t>();
    header.time_base_ns = reader.template number<std::uint64_t>();
    const std::string encoding{reader.text()};
    reader.template number<std::uint8_t>();  // of all encodings the bytes are little endian
    const auto payload = reader.block();
    const auto known = event_packet_encoding(encoding);
    if (!reader.good() || !known || !take_size(width, height)) return false;
    if (packets_ && encoding != encoding_) return false;
    if (!packets_) {
        packets_.emplace(*known, width_, height_);
        encoding_ = encoding;
        packet_damage_ = {};
    }
    if (is_gap_before(sequence)) {
        packets_->resync();
        damage.count(DamageReason::bad_record);
    }
    packet_.clear();
    append_event_packet(header, payload, packet_);
    packets_->parse(packet_, into);
    count_damage_of_packets(damage);
    return true;
}

void RosData::count_damage_of_packets(Damage& damage) {
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        damage.count(DamageReason(i),
                     packets_->damaged()[DamageReason(i)] - packet_damage_[DamageReason(i)]);
    packet_damage_ = packets_->damaged();
}

void RosData::finish(Batch& into, Damage& damage) {
    if (!packets_) return;
    packets_->finish(into);
    count_damage_of_packets(damage);
}

/// Who records may lose messages. Not all drivers count: the same number once more is no gap.
bool RosData::is_gap_before(std::uint64_t sequence) {
    const auto before = std::exchange(sequence_, sequence);
    return before && sequence != *before && sequence != *before + 1;
}

template <typename Reader>
bool RosData::take_image(Reader& reader, Batch& into) {
    RosImage fields;
    const std::int64_t stamp_ns = reader.header();
    fields.height = reader.template number<std::uint32_t>();
    fields.width = reader.template number<std::uint32_t>();
    fields.encoding = reader.text();
    fields.big_endian = reader.template number<std::uint8_t>() != 0;
    fields.step = reader.template number<std::uint32_t>();
    fields.bytes = reader.block();
    if (!reader.good() || !is_size(fields.width, fields.height)) return false;
    // Before the first event nobody knows whose image it is; who reads on does.
    if (width_ > 0 && (int(fields.width) != width_ || int(fields.height) != height_)) return false;
    auto image = image_of(fields);
    if (!image) return false;
    image->t = image->exposure_begin = image->exposure_end = rounded(stamp_ns);
    into.images.push_back(*std::move(image));
    return true;
}

void RosData::restart() {
    packets_.reset();
    packet_damage_ = {};
    sequence_.reset();
}

}  // namespace eventide
