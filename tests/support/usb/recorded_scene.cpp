#include "tests/support/usb/recorded_scene.h"

#include "src/core/error.h"
#include "tests/support/usb/davis_sensors.h"

#include <algorithm>
#include <string>

namespace eventide::testing_support {
namespace {

Batch read_all(Recording& recording) {
    Batch data;
    const auto parser = recording.make_parser();
    for (RawPacket packet; recording.read(packet) == ReadStatus::data;)
        parser->parse(packet.bytes, data);
    parser->finish(data);
    return data;
}

/// The camera counts from its reset, so the recording begins there too.
void begin_at_zero(Batch& data) {
    SensorTime first = SensorTime::max();
    if (!data.events.empty()) first = std::min(first, data.events.front().t);
    for (const auto& image : data.images) first = std::min(first, image.exposure_begin);
    for (const auto& sample : data.imu) first = std::min(first, sample.t);
    for (const auto& edge : data.triggers) first = std::min(first, edge.t);
    const SensorDuration shift = first.time_since_epoch();
    for (auto& event : data.events) event.t -= shift;
    for (auto& sample : data.imu) sample.t -= shift;
    for (auto& edge : data.triggers) edge.t -= shift;
    for (auto& image : data.images) {
        image.t -= shift;
        image.exposure_begin -= shift;
        image.exposure_end -= shift;
    }
    std::erase_if(data.images, [](const ReferenceImage& image) { return image.channels != 1; });
}

}  // namespace

DavisSensor sensor_for(const SensorInfo& info) {
    DavisSensor sensor;
    if (info.width == 240 && info.height == 180) sensor = davis240();
    if (info.width > sensor.width() || info.height > sensor.height())
        throw Error(ErrorKind::usage, "the recording is " + std::to_string(info.width) + "x" +
                                          std::to_string(info.height) +
                                          ", the largest camera here is 346x260");
    return sensor;
}

Batch scene_of(Recording& recording) {
    Batch data = read_all(recording);
    begin_at_zero(data);
    return data;
}

}  // namespace eventide::testing_support
