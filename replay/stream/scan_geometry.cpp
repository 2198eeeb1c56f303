// One pass over the events for the smallest sensor that holds them.
#include "replay/stream/scan_geometry.h"

#include "replay/open_options.h"
#include "src/core/damage_text.h"
#include "src/core/error.h"

#include <algorithm>

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

std::string text_of(const SensorSize& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::string remark_on(const Damage& damage) {
    return damage.total() == 0 ? "" : " (left out as damaged: " + damage_text(damage) + ")";
}

}  // namespace

void SensorSizeSearch::add(const Batch& batch) {
    for (const Event& event : batch.events) count(event.x + 1, event.y + 1, 1);
    // An image is as good as an event at each of its pixels.
    for (const ReferenceImage& image : batch.images) {
        const int width = image.pixels.width() / std::max(image.channels, 1);
        count(image.x0 + width, image.y0 + image.pixels.height(),
              std::uint64_t(width) * std::uint64_t(image.pixels.height()));
    }
}

void SensorSizeSearch::count(int width, int height, std::uint64_t weight) {
    for (std::size_t i = 0; i < kSensors; ++i)
        outside_[i] +=
            width > kKnownSensors[i].width || height > kKnownSensors[i].height ? weight : 0;
    total_ += weight;
    width_ = std::max(width_, width);
    height_ = std::max(height_, height);
}

/// kSensors where none holds all but a few.
std::size_t SensorSizeSearch::smallest() const {
    std::size_t i = 0;
    while (i < kSensors && outside_[i] > total_ / kEventsPerOutlier) ++i;
    return i;
}

void SensorSizeSearch::conclude(const std::string& path, const Damage& left_out,
                                StreamHeader& header, std::vector<std::string>& remarks) const {
    static_assert(kKnownSensors.size() == kSensors);
    if (total_ == 0)
        throw Error(ErrorKind::input,
                    path + ": expected events, to find the size of the sensor, found none" +
                        remark_on(left_out) + "; " + kStateSize);
    const std::size_t found = smallest();
    if (found == kSensors)
        throw Error(ErrorKind::input,
                    path +
                        ": expected the size of the sensor, found none in the recording "
                        "and events that need " +
                        text_of({width_, height_}) + " px, more than the largest sensor known (" +
                        text_of(kKnownSensors.back()) + "); " + kStateSize);
    header.width = kKnownSensors[found].width;
    header.height = kKnownSensors[found].height;
    std::string remark = "the recording does not say the sensor's size: taken for " +
                         text_of(kKnownSensors[found]) +
                         ", the smallest sensor known that holds its events";
    if (const auto n = outside_[found]; n > 0)
        remark += " but " + std::to_string(n) + " of " + std::to_string(total_);
    remarks.push_back(remark + "; if it is another, " + kStateSize);
}

void scan_geometry(const ByteFile& file, OpenedStream& stream) {
    StreamHeader wide = stream.header;
    wide.width = wide.height = kLargestSensorSide;
    const auto parser = stream.make_parser(wide);
    SensorSizeSearch search;
    Batch batch;
    const auto look = [&] {
        search.add(batch);
        batch.clear();
    };
    std::uint64_t position = stream.header.data_offset;
    std::vector<std::byte> bytes(
        std::size_t(std::clamp<std::uint64_t>(file.size(), 1, FileRecording::kChunkBytes)));
    for (std::size_t n = bytes.size(); n == bytes.size(); position += n) {
        n = file.read_at(position, bytes);
        parser->parse({bytes.data(), n}, batch);
        look();
    }
    parser->finish(batch);
    look();
    search.conclude(file.path(), parser->damaged(), stream.header, stream.remarks);
}

}  // namespace eventide
