// Simulations behind the public face.
#include "src/core/error.h"
#include "src/simulate/scene/textures_folder.h"
#include "src/simulate/sim_recording.h"

#include <eventide/simulation.h>

#include <utility>

namespace eventide {
namespace {

SimRecordingSettings settings_of(const SimulationOptions& options) {
    const SimulationPreset& preset = simulation_preset(options.scene);
    return {.scene = preset.scene,
            .sensor = preset.sensor,
            .width = options.width,
            .height = options.height,
            .seed = options.seed != 0 ? options.seed : preset.seed,
            .seconds = options.seconds,
            .images_per_second = options.images_per_second,
            .truths_per_second = options.truths_per_second,
            .truth_scale = options.truth_scale};
}

}  // namespace

class EventSimulation::Impl {
public:
    explicit Impl(const SimulationOptions& options)
        : info_{.name = "simulated " + options.scene,
                .serial = std::to_string(settings_of(options).seed),
                .format = "simulation",
                .width = options.width,
                .height = options.height},
          recording_(settings_of(options), open_textures(options.textures, kProceduralTextures)) {}

    bool read(Batch& batch, std::vector<TrueImage>& truths) {
        const bool more = recording_.next(batch, truths_);
        if (!more) {
            batch.clear();
            truths_.clear();
        }
        truths.clear();
        for (Truth& truth : truths_) truths.push_back({truth.t, std::move(truth.image)});
        return more;
    }

    const SensorInfo& info() const { return info_; }
    SensorTime clock() const { return recording_.now(); }

private:
    SensorInfo info_;
    SimRecording recording_;
    std::vector<Truth> truths_;
};

EventSimulation::EventSimulation(const SimulationOptions& options)
    : impl_(std::make_unique<Impl>(options)) {}
EventSimulation::~EventSimulation() = default;
EventSimulation::EventSimulation(EventSimulation&&) noexcept = default;
EventSimulation& EventSimulation::operator=(EventSimulation&&) noexcept = default;

const SensorInfo& EventSimulation::info() const noexcept {
    return impl_->info();
}
int EventSimulation::width() const noexcept {
    return info().width;
}
int EventSimulation::height() const noexcept {
    return info().height;
}
bool EventSimulation::read(Batch& batch, std::vector<TrueImage>& truths) {
    return impl_->read(batch, truths);
}
SensorTime EventSimulation::clock() const noexcept {
    return impl_->clock();
}

std::vector<std::string> EventSimulation::scenes() {
    std::vector<std::string> names;
    for (const SimulationPreset& preset : simulation_presets()) names.push_back(preset.name);
    return names;
}

}  // namespace eventide
