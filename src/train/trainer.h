// The loop: windows in, weights out, until the budget is spent or somebody asks it to stop.
#pragma once

#include "src/train/checkpoint.h"
#include "src/train/options.h"
#include "src/train/validation.h"

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace eventide {

/// bfloat16 where the processor has instructions for it (or on a GPU), else float32; or what the
/// option says. Throws Error(usage).
torch::ScalarType arithmetic_type(const TrainOptions& options);

class Trainer {
public:
    using Say = std::function<void(const std::string&)>;  ///< a line for whoever watches

    /// Starts anew, or where options.resume says. Throws Error.
    Trainer(const TrainOptions& options, std::shared_ptr<const TextureLibrary> textures,
            std::shared_ptr<const TextureLibrary> validation_textures, Say say);

    /// Trains until the budget is spent or `stop` is set, then writes a checkpoint. Files in the
    /// output folder: checkpoint.safetensors, best.safetensors, log.csv, validation.csv,
    /// learning_curve.svg, sheet.pgm.
    void run(const std::atomic<bool>& stop);

    /// The chosen weights (of the best validation, else the running mean), with sigma calibrated
    /// on held-out scenes and the card written.
    Model finished_model() const;

    std::int64_t steps() const { return progress_.window; }
    const Parameters& parameters() const { return optimiser_.parameters; }

private:
    struct Share {  // what one thread of a step gives
        Parameters gradients;
        LossTerms terms;
    };
    void begin_memories();
    bool finished() const;
    double learning_rate() const;
    void step();
    Share run_share(std::span<const LaneWindow> windows, const WindowPlan& plan, Memory& memory);
    void log_step(const LossTerms& terms, double rate, double norm, double seconds);
    void validate();
    void checkpoint();
    std::filesystem::path file(const char* name) const;

    TrainOptions options_;
    Say say_;
    torch::Device device_;
    torch::ScalarType type_;
    Optimiser optimiser_;
    torch::Tensor input_mask_;
    std::unique_ptr<Perceptual> perceptual_;
    std::unique_ptr<Validation> validation_;
    std::unique_ptr<Feed> feed_;
    Checkpoint progress_;
    std::array<double, kLossNames.size() + 2> sums_{};  // since the last line: means, norm, seconds
    int summed_ = 0, skipped_ = 0;
};

}  // namespace eventide
