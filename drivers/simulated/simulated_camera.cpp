// Simulates a little ahead, writes bytes, and waits for their time.
#include "drivers/simulated/simulated_camera.h"

#include "src/simulate/scene/textures_folder.h"

#include <cmath>

namespace eventide {

namespace {

SimRecordingSettings in_chunks(SimRecordingSettings settings, SensorDuration chunk) {
    settings.chunk = chunk;
    return settings;
}

}  // namespace

SimulatedCamera::SimulatedCamera(const SimulatedSourceSettings& settings)
    : info_{.name = "simulated " + settings.scene,
            .serial = std::to_string(settings.recording.seed),
            .format = "aedat3",
            .width = settings.recording.width,
            .height = settings.recording.height},
      speed_(settings.speed),
      recording_(in_chunks(settings.recording, kChunk),
                 open_textures(settings.textures, kProceduralTextures)) {}

HostTime SimulatedCamera::due(SensorTime t) {
    const HostTime now = std::chrono::steady_clock::now();
    const auto at = [&] {
        const double us = double((t - anchor_->sensor).count()) / speed_;
        return anchor_->host + std::chrono::microseconds(std::llround(us));
    };
    if (!anchor_ || now - at() > kMaxLateness) anchor_ = {now, t};
    return at();
}

/// False when stopped.
bool SimulatedCamera::wait_until(HostTime due) {
    std::unique_lock lock(mutex_);
    return !changed_.wait_until(lock, due, [&] { return stopped_; });
}

ReadStatus SimulatedCamera::read(RawPacket& into) {
    into.bytes.clear();
    const HostTime silent_until = std::chrono::steady_clock::now() + kSilence;
    while (into.bytes.empty()) {
        if (!recording_.next(batch_, truths_)) return ReadStatus::end;
        const HostTime when = speed_ > 0 ? due(recording_.now()) : std::chrono::steady_clock::now();
        if (!wait_until(when)) return ReadStatus::end;
        writer_.write(batch_, into.bytes);
        if (is_live() && into.bytes.empty() && when >= silent_until) return ReadStatus::timeout;
    }
    into.arrived = std::chrono::steady_clock::now();
    count(CameraCount::transfers);
    count(CameraCount::bytes, into.bytes.size());
    return ReadStatus::data;
}

void SimulatedCamera::stop() noexcept {
    {
        const std::lock_guard lock(mutex_);
        stopped_ = true;
    }
    changed_.notify_all();
}

std::unique_ptr<Parser> SimulatedCamera::make_parser() const {
    Aedat3Header header;
    header.stream.format = info_.format;
    header.stream.width = info_.width;
    header.stream.height = info_.height;
    return std::make_unique<Aedat3Parser>(header, info_.width, info_.height);
}

std::unique_ptr<SimulatedCamera> open_simulation(std::string_view source) {
    return std::make_unique<SimulatedCamera>(parse_simulated_name(source));
}

}  // namespace eventide
