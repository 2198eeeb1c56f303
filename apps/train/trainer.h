// The loop: segments in, weights out, until the budget is spent or somebody asks it to stop.
#pragma once

#include "apps/train/checkpoint.h"
#include "apps/train/options.h"
#include "apps/train/teacher.h"
#include "apps/train/training_log.h"

#include <atomic>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <vector>

namespace eventide {

class Trainer {
public:
    /// Starts anew, or where options.resume says. Throws Error.
    Trainer(const TrainOptions& options, std::shared_ptr<const TextureLibrary> textures,
            std::shared_ptr<const TextureLibrary> validation_textures, const LogSink& say);

    /// Trains until the budget is spent or `stop` is set, then writes a checkpoint. Files in the
    /// output folder: checkpoint.safetensors, best.safetensors, log.csv, validation.csv,
    /// learning_curve.svg, sheet.pgm.
    void run(const std::atomic<bool>& stop);

    /// Writes the run as it stands, to go on from; its streams then begin anew.
    void keep(const std::filesystem::path& path) const;

    /// The chosen weights (of the best validation, else the running mean), with sigma calibrated
    /// on held-out scenes and the card written.
    Model finished_model() const;

    std::int64_t steps() const { return progress_.segment; }
    const Parameters& parameters() const { return optimiser_.parameters; }

private:
    struct Share {  // what one thread of a step gives
        Parameters gradients;
        LossTerms terms;
    };
    void resume();
    void leave_out_inputs();
    void begin_states();
    void begin_teacher_states(std::size_t places);
    bool finished() const;
    double learning_rate() const;
    void step();
    std::vector<TrainingBatch> load();
    std::vector<TrainingBatch> next_batches();
    torch::Tensor taught(const torch::Tensor& truth, const TrainingBatch& batch,
                         const SegmentPlan& plan, int place);
    Share run_share(const TrainingBatch& batch, const SegmentPlan& plan, int place);
    std::vector<Share> run_shares(const std::vector<TrainingBatch>& batches,
                                  const SegmentPlan& plan, int first_place);
    static Share mean_of(std::vector<Share> shares);
    Mark mark() const { return {progress_.segment, progress_.elapsed_minutes}; }
    Validation::Scores scores_of(const Parameters& weights) const;
    void judge_again();
    bool has_best() const;
    void validate();
    void checkpoint();
    std::filesystem::path file(const char* name) const;

    TrainOptions options_;
    TrainingLog log_;
    torch::Device device_;
    torch::ScalarType type_;
    Optimiser optimiser_;
    torch::Tensor input_mask_;
    std::unique_ptr<Perceptual> perceptual_;
    std::unique_ptr<const Teacher> teacher_;
    std::unique_ptr<Validation> validation_;
    std::unique_ptr<DataLoader> feed_;
    std::future<std::vector<TrainingBatch>> upcoming_;  // of the next step; read from feed_
    Checkpoint progress_;
};

}  // namespace eventide
