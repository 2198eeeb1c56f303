// A model file as a network that runs, made for one sensor.
#include "apps/cli/run/loaded_model.h"

#include "apps/cli/run/report/memory_use.h"
#include "apps/cli/settings/model_path.h"
#include "pipeline/parallel_tbb.h"
#include "src/model/model_trial.h"

#include <new>

namespace eventide::app {

namespace {

/// A model file whose network was seen to work.
Model load_tried_model(const std::filesystem::path& file, bool tries) {
    Model model = load_model(file);
    if (tries) try_model(model, file.string());
    return model;
}

EngineOptions of_one_view(EngineOptions engine) {
    engine.self_ensemble = 1;
    return engine;
}

template <typename Part>
Part made_for(const Model& model, const SensorInfo& sensor, const EngineOptions& engine) {
    try {
        return Part{model, sensor.width, sensor.height, engine};
    } catch (const std::bad_alloc&) {
        throw out_of_memory("the network",
                            std::uint64_t(engine.self_ensemble) *
                                network_bytes(model.config, sensor, engine.precision),
                            sensor);
    }
}

}  // namespace

Network::Network(const RunSettings& settings, const SensorInfo& sensor)
    : file_{find_model(settings.model)},
      model_{load_tried_model(file_, settings.tries_model)},
      engine_{.engine = settings.engine,
              .precision = settings.precision,
              .kernels = settings.kernels,
              .instructions = settings.instructions,
              .parallel_for = parallel_for_with(settings.threads),
              .self_ensemble = settings.self_ensemble},
      encoder_{made_for<Encoder>(model_, sensor, engine_)},
      renderer_{made_for<Renderer>(model_, sensor, engine_)} {}

Encoder Network::make_encoder(const SensorInfo& sensor) const {
    return made_for<Encoder>(model_, sensor, of_one_view(engine_));
}

Renderer Network::make_renderer(const SensorInfo& sensor) const {
    return made_for<Renderer>(model_, sensor, of_one_view(engine_));
}

}  // namespace eventide::app
