// Cuts a simulated stream at the instants of its images.
#include "src/simulate/sim_recording.h"

#include "src/core/error.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace eventide {

namespace {

const SimRecordingSettings& checked(const SimRecordingSettings& s) {
    const auto refuse = [](const std::string& what, double found) {
        char number[32];
        std::snprintf(number, sizeof number, "%.15g", found);
        throw Error(ErrorKind::usage,
                    "simulated recording: expected " + what + ", found " + number);
    };
    if (s.width < 2 || s.width > 8192) refuse("a width from 2 to 8192 px", s.width);
    if (s.height < 2 || s.height > 8192) refuse("a height from 2 to 8192 px", s.height);
    if (!(s.seconds >= 0 && s.seconds <= 1e9)) refuse("0 to 1000000000 seconds", s.seconds);
    constexpr double kMaxPerSecond = 1e5;
    for (const double rate : {s.images_per_second, s.truths_per_second})
        if (!(rate >= 0 && rate <= kMaxPerSecond)) refuse("0 to 100000 images per second", rate);
    if (!(s.truth_scale > 0 && s.truth_scale <= 64)) refuse("a scale up to 64", s.truth_scale);
    if (s.chunk <= SensorDuration{0}) refuse("a chunk above 0 us", double(s.chunk.count()));
    return s;
}

}  // namespace

std::optional<SensorTime> SimRecording::Ticks::next() const {
    const double us = double(number) * 1e6 / per_second;
    if (per_second <= 0 || us > double(kFarthestUs)) return {};
    return from_us(std::llround(us));
}

SimRecording::SimRecording(const SimRecordingSettings& settings,
                           std::shared_ptr<const TextureLibrary> textures)
    : settings_(checked(settings)),
      stream_(settings.scene, settings.sensor, std::move(textures), settings.width, settings.height,
              settings.seed),
      offset_(settings.begin.time_since_epoch()),
      images_{settings.images_per_second},
      truths_{settings.truths_per_second} {}

bool SimRecording::due(Ticks& ticks) const {
    if (ticks.next() != stream_.now()) return false;
    ++ticks.number;
    return true;
}

Array2<float> SimRecording::view(double scale) const {
    const auto length = [scale](int n) { return int(std::lround((n - 1) * scale)) + 1; };
    Array2<float> view(length(settings_.height), length(settings_.width));
    stream_.truth(stream_.now(), view);
    return view;
}

bool SimRecording::next(Batch& batch, std::vector<Truth>& truths) {
    batch.clear();
    truths.clear();
    const auto take_images = [&] {
        if (due(images_)) batch.images.push_back(reference_image(now(), view(1)));
        if (due(truths_)) truths.push_back({now(), view(settings_.truth_scale)});
    };
    if (stream_.now() == SensorTime{}) {
        take_images();  // by themselves: no event is before them
        if (!batch.images.empty() || !truths.empty()) return true;
    }

    SensorTime end = stream_.now() + settings_.chunk;
    if (settings_.seconds > 0) end = std::min(end, from_us(std::llround(settings_.seconds * 1e6)));
    for (const Ticks& ticks : {images_, truths_})
        if (const auto t = ticks.next()) end = std::min(end, *t);
    if (end <= stream_.now()) return false;
    stream_.advance(end, batch.events);
    for (Event& event : batch.events) event.t += offset_;
    take_images();
    return true;
}

void simulate_recording(const SimRecordingSettings& settings,
                        std::shared_ptr<const TextureLibrary> textures,
                        const std::function<bool(const Batch&, const std::vector<Truth>&)>& emit) {
    SimRecording recording{settings, std::move(textures)};
    Batch batch;
    std::vector<Truth> truths;
    while (recording.next(batch, truths))
        if (!emit(batch, truths)) return;
}

ReferenceImage reference_image(SensorTime t, const Array2<float>& view) {
    ReferenceImage image;
    image.t = image.exposure_begin = image.exposure_end = t;
    image.pixels = Array2<std::uint16_t>(view.height(), view.width());
    for (std::size_t i = 0; i < view.values().size(); ++i)
        image.pixels.values()[i] =
            // NOLINTNEXTLINE(bugprone-incorrect-roundings): never below 0
            std::uint16_t(std::clamp(view.values()[i], 0.f, 1.f) * 65535 + .5f);
    return image;
}

}  // namespace eventide
