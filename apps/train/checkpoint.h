// A run in one file, so that it goes on as if it had never stopped.
#pragma once

#include "apps/train/data/batch.h"
#include "apps/train/optimiser.h"
#include "src/nn/safetensors.h"

#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

/// The score of a run that was never validated: above all others.
inline constexpr double kNotJudged = 1e9;

struct Checkpoint {
    std::int64_t segment = 0;  ///< the next one; as many steps are done
    double elapsed_minutes = 0;
    double best_score = kNotJudged;                ///< of the validations so far
    std::string options;                           ///< OptionTable::record()
    std::vector<RecurrentState> recurrent_states;  ///< of each group's and thread's streams
    std::vector<RecurrentState> teacher_states;    ///< the same of a teacher, view by view
};

/// Writes whole or not at all. Throws Error(failed).
void save_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint,
                     const Optimiser& optimiser);

/// Whether a file says that it is one.
bool is_checkpoint(const TensorFile& file);

/// The options only: they decide what the rest looks like. Throws Error(input).
std::string checkpoint_options(const std::filesystem::path& path);

/// Throws Error(input) naming what does not fit.
Checkpoint load_checkpoint(const std::filesystem::path& path, Optimiser& optimiser);

}  // namespace eventide
