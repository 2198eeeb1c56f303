// Reads a recording through its parser and counts.
#include "replay/summary.h"

#include <nlohmann/json.hpp>

namespace eventide {

namespace {

void add(const Batch& batch, Summary& sum) {
    sum.events += batch.events.size();
    for (const Event& event : batch.events) sum.on += event.polarity == Polarity::on;
    if (!batch.events.empty()) {
        if (!sum.first) sum.first = batch.events.front().t;
        sum.last = batch.events.back().t;
    }
    sum.frames += batch.images.size();
    sum.imu += batch.imu.size();
    sum.triggers += batch.triggers.size();
}

}  // namespace

Summary summarize(Recording& recording, const std::function<bool()>& progress) {
    const SensorInfo& info = recording.info();
    Summary sum{info.format, info.width, info.height, 0, 0, {}, {}, 0, 0, 0, {}};
    const auto parser = recording.make_parser();
    RawPacket packet;
    Batch batch;
    while (recording.read(packet) == ReadStatus::data) {
        parser->parse(packet.bytes, batch);
        add(batch, sum);
        batch.clear();
        if (progress && !progress()) break;
    }
    parser->finish(batch);
    add(batch, sum);
    sum.damaged = parser->damaged();
    return sum;
}

std::optional<SensorTime> first_event_time(Recording& recording) {
    const auto parser = recording.make_parser();
    RawPacket packet;
    Batch batch;
    while (batch.events.empty() && recording.read(packet) == ReadStatus::data)
        parser->parse(packet.bytes, batch);
    parser->finish(batch);
    if (batch.events.empty()) return {};
    return batch.events.front().t;
}

std::string to_json(const Summary& sum) {
    nlohmann::ordered_json object{{"format", sum.format},
                                  {"width", sum.width},
                                  {"height", sum.height},
                                  {"events", sum.events},
                                  {"on", sum.on},
                                  {"first_us", nullptr},
                                  {"last_us", nullptr},
                                  {"frames", sum.frames},
                                  {"imu", sum.imu},
                                  {"triggers", sum.triggers},
                                  {"damaged", nlohmann::ordered_json::object()}};
    if (sum.first) object["first_us"] = to_us(*sum.first);
    if (sum.last) object["last_us"] = to_us(*sum.last);
    for (std::size_t i = 0; i < kDamageReasons; ++i) {
        const auto reason = DamageReason(i);
        object["damaged"][std::string(name_of(reason))] = sum.damaged[reason];
    }
    return object.dump();
}

}  // namespace eventide
