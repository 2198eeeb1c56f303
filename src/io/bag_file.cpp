// Messages as dvs_msgs and sensor_msgs define them (docs/protocols.md D).
#include "src/io/bag_file.h"

#include "src/core/sensor_limits.h"

namespace eventide {
namespace {

constexpr std::size_t kEventBytes = 13;

}  // namespace

bool BagFile::read(Batch& into) {
    return records_.read([&](const BagRecord& record) {
        if (record.op == BagRecord::connection) take_connection(record);
        if (record.op != BagRecord::message) return;
        const std::uint32_t connection = records_.number(record, "conn");
        if (connection == events_) take_events(record.data, into);
        if (connection == images_) take_image(record.data, into);
    });
}

std::string BagFile::types() const {
    std::string text;
    for (const std::string& type : types_) text += (text.empty() ? "" : ", ") + type;
    return text.empty() ? "no messages" : text;
}

/// Its data are fields once more, the type among them.
void BagFile::take_connection(const BagRecord& record) {
    const std::uint32_t connection = records_.number(record, "conn");
    const auto fields = bag_fields(record.data);
    const auto type = fields.find("type");
    if (type == fields.end()) return;
    types_.insert(std::string{type->second});
    if (type->second == "dvs_msgs/EventArray" && !events_) events_ = connection;
    if (type->second == "sensor_msgs/Image" && !images_) images_ = connection;
}

void BagFile::take_size(std::uint32_t width, std::uint32_t height) {
    constexpr auto kLargest = std::uint32_t(kLargestSensorSide);
    if (width == 0 || height == 0 || width > kLargest || height > kLargest ||
        (width_ > 0 && (int(width) != width_ || int(height) != height_)))
        records_.refuse("expected events and images of one size, at most " +
                        std::to_string(kLargest) + " px each way, found " + std::to_string(width) +
                        "x" + std::to_string(height) + " px beside " + std::to_string(width_) +
                        "x" + std::to_string(height_));
    width_ = int(width);
    height_ = int(height);
}

/// Header, u32 height, u32 width, events of u16 x, u16 y, time, u8 polarity.
void BagFile::take_events(std::span<const std::byte> message, Batch& into) {
    BlockReader reader{message};
    reader.take(12);  // sequence number and time of the message
    reader.block();   // frame_id
    const auto height = reader.number<std::uint32_t>(), width = reader.number<std::uint32_t>();
    const auto count = reader.number<std::uint32_t>();
    BlockReader events{reader.take(std::size_t{count} * kEventBytes)};
    if (!reader.good()) records_.refuse("expected whole event messages, found one cut short");
    take_size(width, height);
    for (std::uint32_t i = 0; i < count; ++i) {
        Event event;
        event.x = events.number<std::uint16_t>();
        event.y = events.number<std::uint16_t>();
        event.t = events.time();
        event.polarity = events.number<std::uint8_t>() != 0 ? Polarity::on : Polarity::off;
        if (event.x < width && event.y < height) into.events.push_back(event);
    }
}

/// Header, u32 height, u32 width, string encoding, u8 big-endian, u32 step, bytes.
void BagFile::take_image(std::span<const std::byte> message, Batch& into) {
    BlockReader reader{message};
    reader.take(4);
    ReferenceImage image;
    image.t = image.exposure_begin = image.exposure_end = reader.time();
    reader.block();
    const auto height = reader.number<std::uint32_t>(), width = reader.number<std::uint32_t>();
    const std::string encoding{text_of(reader.block())};
    reader.take(1);
    const auto step = reader.number<std::uint32_t>();
    const auto pixels = reader.block();
    if (!reader.good() || step < width || pixels.size() < std::size_t{step} * height)
        records_.refuse("expected whole images, found one cut short");
    if (encoding != "mono8" && encoding != "8UC1")
        records_.refuse("expected images of 8 bit grey (mono8), found '" + encoding + "'");
    take_size(width, height);
    image.pixels = Array2<std::uint16_t>(height_, width_);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x)
            image.pixels(y, x) = std::uint16_t(
                257 * std::to_integer<int>(pixels[std::size_t(y) * step + std::size_t(x)]));
    into.images.push_back(std::move(image));
}

}  // namespace eventide
