#include "tests/drivers/davis_streams.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>

namespace eventide::test {

using testing_support::DavisModel;
using testing_support::UsbTestbed;

Batch davis_scene(const DavisSensor& sensor, SceneSettings settings) {
    std::mt19937 rng{settings.seed};
    Batch batch;
    std::int64_t t = 10;
    for (int i = 0; i < settings.events; ++i) {
        const unsigned pause = rng() % 64 == 0 ? settings.longest_pause_us : 3;
        t += std::int64_t(rng() % std::max(pause, 1U));
        batch.events.push_back({from_us(t), std::uint16_t(rng() % unsigned(sensor.width())),
                                std::uint16_t(rng() % unsigned(sensor.height())),
                                Polarity(rng() % 2)});
    }
    for (int i = 1; i <= 3; ++i) {
        ReferenceImage image;
        image.exposure_begin = from_us(t * i / 4);
        image.exposure_end = image.exposure_begin + SensorDuration{4000};
        image.t = image.exposure_begin + SensorDuration{2000};
        image.pixels = Array2<std::uint16_t>{sensor.height(), sensor.width()};
        for (auto& pixel : image.pixels.values()) {
            // DAVIS240 sends half of each level, so its values are even.
            const auto value = unsigned(rng() % 511) * 2;
            pixel = std::uint16_t((value << 6) | (value >> 4));
        }
        batch.images.push_back(std::move(image));
        batch.imu.push_back({from_us(t * i / 5), {0, 0, 1}, {}, {}, 35});
    }
    return batch;
}

DavisOptions at_once() {
    DavisOptions options;
    options.waits = {std::chrono::milliseconds{0}, std::chrono::milliseconds{0},
                     std::chrono::milliseconds{0}};
    return options;
}

std::string failure_of(const std::function<void()>& what) {
    try {
        what();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::device);
        return error.what();
    }
    return "nothing was thrown";
}

Streamed stream(DavisCamera& camera, UsbTestbed& bed, const DavisModel& model) {
    const auto parser = camera.make_parser();
    Streamed streamed;
    RawPacket packet;
    for (bool over = false; !over;) {
        const ReadStatus status = camera.read(packet);
        if (status == ReadStatus::end) break;
        if (status == ReadStatus::timeout) bed.look([&] { over = model.is_scene_over(); });
        if (status != ReadStatus::data) continue;
        if (packet.gap_before) {
            streamed.gaps.push_back(streamed.data.events.size());
            parser->resync();
        }
        streamed.bytes += packet.bytes.size();
        parser->parse(packet.bytes, streamed.data);
    }
    parser->finish(streamed.data);
    streamed.damaged = parser->damaged();
    return streamed;
}

std::shared_ptr<DavisModel> camera_before(int events) {
    const auto model = std::make_shared<DavisModel>(testing_support::DavisModelSettings{});
    model->show(davis_scene(model->settings().sensor, {.events = events}));
    return model;
}

DavisOptions small_transfers(bool reconnect) {
    DavisOptions options = at_once();
    options.settings.transfers = {4, 8 << 10};
    options.reconnect = reconnect;
    return options;
}

Streamed streamed_by(PluggedIn& camera_side) {
    DavisOptions options = at_once();
    options.settings.transfers.bytes = 8 << 10;
    DavisCamera camera{options};
    return stream(camera, camera_side.bed, *camera_side.model);
}

bool is_part_of(const std::vector<Event>& some, const std::vector<Event>& all) {
    auto at = all.begin();
    for (const Event& event : some) {
        at = std::find(at, all.end(), event);
        if (at == all.end()) return false;
        ++at;
    }
    return true;
}

}  // namespace eventide::test
