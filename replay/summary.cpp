// Reads a recording through its parser and counts.
#include "replay/summary.h"

#include "src/binning/flicker_period.h"

#include <nlohmann/json.hpp>

namespace eventide {

namespace {

/// A header may claim any size; larger sensors are not looked at for flicker.
constexpr std::int64_t kMostPixels = std::int64_t{1} << 24;

class FlickerSeen {
public:
    FlickerSeen(int width, int height) : width_(width), height_(height) {}

    void add(const std::vector<Event>& events, Summary& sum) {
        if (events.empty() || std::int64_t{width_} * height_ > kMostPixels) return;
        if (!period_) period_.emplace(width_, height_);
        for (const Event& event : events) {
            if (event.x >= width_ || event.y >= height_) continue;
            period_->see(event);
            if (period_->us() <= 0) continue;
            ++sum.in_flicker;
            sum.flicker_hz += (1e6 / period_->us() - sum.flicker_hz) / double(sum.in_flicker);
        }
    }

private:
    int width_, height_;
    std::optional<FlickerPeriod> period_;
};

void add(const Batch& batch, FlickerSeen& flicker, Summary& sum) {
    flicker.add(batch.events, sum);
    sum.events += batch.events.size();
    for (const Event& event : batch.events) sum.on += event.polarity == Polarity::on;
    for (const Event& event : batch.events) {
        if (!sum.first) sum.first = sum.last = event.t;
        // Parsers leave out what goes back for any other reason.
        if (event.t < *sum.last)
            ++sum.clock_resets;
        else
            sum.span += event.t - *sum.last;
        sum.last = event.t;
    }
    sum.frames += batch.images.size();
    sum.imu += batch.imu.size();
    sum.triggers += batch.triggers.size();
}

}  // namespace

Summary summarize(Recording& recording, const std::function<bool()>& progress) {
    const SensorInfo& info = recording.info();
    Summary sum;
    sum.format = info.format;
    sum.width = info.width;
    sum.height = info.height;
    FlickerSeen flicker{info.width, info.height};
    const auto parser = recording.make_parser();
    RawPacket packet;
    Batch batch;
    while (recording.read(packet) == ReadStatus::data) {
        parser->parse(packet.bytes, batch);
        add(batch, flicker, sum);
        batch.clear();
        if (progress && !progress()) break;
    }
    parser->finish(batch);
    add(batch, flicker, sum);
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
                                  {"clock_resets", sum.clock_resets},
                                  {"frames", sum.frames},
                                  {"imu", sum.imu},
                                  {"triggers", sum.triggers},
                                  {"flicker_hz", nullptr},
                                  {"in_flicker", sum.in_flicker},
                                  {"damaged", nlohmann::ordered_json::object()}};
    if (sum.first) object["first_us"] = to_us(*sum.first);
    if (sum.in_flicker > 0) object["flicker_hz"] = sum.flicker_hz;
    if (sum.last) object["last_us"] = to_us(*sum.last);
    for (std::size_t i = 0; i < kDamageReasons; ++i) {
        const auto reason = DamageReason(i);
        object["damaged"][std::string(name_of(reason))] = sum.damaged[reason];
    }
    return object.dump();
}

}  // namespace eventide
