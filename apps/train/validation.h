// Scenes nobody learns from: they choose the weights and set the scale of sigma.
#pragma once

#include "apps/train/data/batch.h"

#include <array>
#include <filesystem>
#include <vector>

namespace eventide {

struct ValidationSettings {
    int scenes = 12, event_windows = 40, crop = 96;
    std::uint64_t seed = 4242;
};

class Validation {
public:
    /// Simulates all scenes at once and keeps them.
    Validation(const ValidationSettings& settings, DataSettings data,
               std::shared_ptr<const TextureLibrary> textures, torch::Device device);

    struct Scores {
        double score = 0;                               ///< the loss: what the choice goes by
        std::array<double, kLossNames.size()> means{};  ///< as LossTerms
    };
    /// Means over all scenes, states carried from the first event window on.
    Scores judge(const ModelConfig& config, const Parameters& parameters, int lookahead,
                 const LossWeights& weights, const Perceptual* perceptual) const;

    /// The factor on sigma at which 80 % of the truth lies within 1.2816 sigma.
    double sigma_scale(const ModelConfig& config, const Parameters& parameters,
                       int lookahead) const;

    /// A row per scene: truth, mu, twice sigma; the last image of each. A PGM file.
    void write_sheet(const std::filesystem::path& path, const ModelConfig& config,
                     const Parameters& parameters, int lookahead) const;

private:
    Images render_scene(const ModelConfig& config, const Parameters& parameters, std::size_t scene,
                        int lookahead) const;

    DataSettings data_;
    SegmentPlan plan_;
    std::vector<TrainingBatch> scenes_;
};

}  // namespace eventide
