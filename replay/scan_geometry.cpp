// One pass over the events for the smallest sensor that holds them.
#include "replay/scan_geometry.h"

#include "src/core/error.h"

#include <algorithm>
#include <array>
#include <string>

namespace eventide {

namespace {

struct SensorSize {
    int width, height;
};

/// Of event cameras that are or were sold, by area.
constexpr std::array<SensorSize, 8> kKnownSensors{{{128, 128},     // DVS128
                                                   {240, 180},     // DAVIS240
                                                   {304, 240},     // ATIS
                                                   {320, 240},     // DVXplorer Lite
                                                   {346, 260},     // DAVIS346
                                                   {320, 320},     // GenX320
                                                   {640, 480},     // DVXplorer, Gen3
                                                   {1280, 720}}};  // Gen4, IMX636

/// Of the events, how many damaged coordinates may lie outside the sensor.
constexpr std::uint64_t kEventsPerOutlier = 1000;

/// How many events each known sensor holds.
class Tally {
public:
    void add(const Batch& batch) {
        for (const Event& event : batch.events) count(event.x + 1, event.y + 1, 1);
        // An image is as good as an event at each of its pixels.
        for (const ReferenceImage& image : batch.images) {
            const int width = image.pixels.width() / std::max(image.channels, 1);
            count(image.x0 + width, image.y0 + image.pixels.height(),
                  std::uint64_t(width) * std::uint64_t(image.pixels.height()));
        }
    }
    std::uint64_t total() const { return total_; }
    std::uint64_t outside(std::size_t sensor) const { return outside_[sensor]; }
    SensorSize extent() const { return extent_; }

    /// The smallest sensor that holds all but a few; kKnownSensors.size() where none does.
    std::size_t smallest() const {
        std::size_t i = 0;
        while (i < kKnownSensors.size() && outside_[i] > total_ / kEventsPerOutlier) ++i;
        return i;
    }

private:
    void count(int width, int height, std::uint64_t weight) {
        for (std::size_t i = 0; i < kKnownSensors.size(); ++i)
            outside_[i] +=
                width > kKnownSensors[i].width || height > kKnownSensors[i].height ? weight : 0;
        total_ += weight;
        extent_ = {std::max(extent_.width, width), std::max(extent_.height, height)};
    }

    std::array<std::uint64_t, kKnownSensors.size()> outside_{};
    std::uint64_t total_ = 0;
    SensorSize extent_{0, 0};
};

std::string text_of(const SensorSize& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

/// " (bad_record 3)"
std::string left_out(const Damage& damage) {
    std::string reasons;
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        if (const auto n = damage[DamageReason(i)]; n > 0)
            reasons += (reasons.empty() ? "" : ", ") + std::string(name_of(DamageReason(i))) + " " +
                       std::to_string(n);
    return reasons.empty() ? "" : " (left out as damaged: " + reasons + ")";
}

Tally read_through(const ByteFile& file, std::uint64_t position, Parser& parser) {
    Tally tally;
    Batch batch;
    const auto look = [&] {
        tally.add(batch);
        batch.clear();
    };
    std::vector<std::byte> bytes(FileRecording::kChunkBytes);
    for (std::size_t n = bytes.size(); n == bytes.size(); position += n) {
        n = file.read_at(position, bytes);
        parser.parse({bytes.data(), n}, batch);
        look();
    }
    parser.finish(batch);
    look();
    return tally;
}

}  // namespace

void scan_geometry(const ByteFile& file, OpenedStream& stream) {
    StreamHeader wide = stream.header;
    wide.width = wide.height = kLargestSensorSide;
    const auto parser = stream.make_parser(wide);
    const Tally tally = read_through(file, stream.header.data_offset, *parser);
    if (tally.total() == 0)
        throw Error(ErrorKind::input,
                    file.path() + ": expected events, to find the size of the sensor, found none" +
                        left_out(parser->damaged()) + "; state it with --input-size WIDTHxHEIGHT");
    const std::size_t found = tally.smallest();
    if (found == kKnownSensors.size())
        throw Error(ErrorKind::input,
                    file.path() +
                        ": expected the size of the sensor, found none in the recording "
                        "and events that need " +
                        text_of(tally.extent()) + " px, more than the largest sensor known (" +
                        text_of(kKnownSensors.back()) +
                        "); state it with --input-size WIDTHxHEIGHT");
    const SensorSize& size = kKnownSensors[found];
    stream.header.width = size.width;
    stream.header.height = size.height;
    std::string remark = "the recording does not say the sensor's size: taken for " +
                         text_of(size) + ", the smallest sensor known that holds its events";
    if (const auto n = tally.outside(found); n > 0)
        remark += " but " + std::to_string(n) + " of " + std::to_string(tally.total());
    stream.remarks.push_back(remark + "; --input-size states another");
}

}  // namespace eventide
