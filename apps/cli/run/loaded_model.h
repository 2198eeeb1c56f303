// A model file as a network that runs, made for one sensor.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "src/model/encode/encoder.h"
#include "src/model/model_file.h"
#include "src/model/render/renderer.h"

#include <eventide/event.h>

#include <filesystem>

namespace eventide::app {

/// Throws Error (input) when the model cannot be found, is not one or gives no finite frames; Error
/// (failed) when there is too little memory for it.
class Network {
public:
    Network(const RunSettings& settings, const SensorInfo& sensor);

    const std::filesystem::path& file() const { return file_; }
    const ModelConfig& config() const { return model_.config; }
    const Model& model() const { return model_; }
    Encoder& encoder() { return encoder_; }
    const Encoder& encoder() const { return encoder_; }
    Renderer& renderer() { return renderer_; }
    /// More of the same, without an ensemble, for a sensor of another size. Throws Error (failed)
    /// as above.
    Encoder make_encoder(const SensorInfo& sensor) const;
    Renderer make_renderer(const SensorInfo& sensor) const;

private:
    std::filesystem::path file_;
    Model model_;
    EngineOptions engine_;
    Encoder encoder_;
    Renderer renderer_;
};

}  // namespace eventide::app
