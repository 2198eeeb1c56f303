// A model file as a network that runs, made for one sensor.
#include "src/app/network.h"

#include "pipeline/parallel_tbb.h"
#include "src/app/model_path.h"
#include "src/nn/safetensors.h"

namespace eventide::app {

Network::Network(const RunSettings& settings, const SensorInfo& sensor)
    : file_{find_model(settings.model)},
      model_{load_model(file_)},
      engine_{settings.engine, settings.precision, settings.kernels,
              parallel_for_with(settings.threads)},
      encoder_{model_, sensor.width, sensor.height, engine_},
      renderer_{model_, sensor.width, sensor.height, engine_} {
    if (!settings.state_in.empty())
        encoder_.restore(read_safetensors(settings.state_in), settings.state_in);
}

}  // namespace eventide::app
