// A finished network whose frames another learns from (Hinton et al. 2015, arXiv 1503.02531). The
// truth carries all that events do not tell (exposure, what no edge has crossed), which only large
// batches average out; what a better network makes of the same events does not.
#pragma once

#include "apps/train/data/batch.h"

#include <filesystem>
#include <span>
#include <vector>

namespace eventide {

class Teacher {
public:
    /// `views` 2 or 4: its frame is the mean of those of the scene as it is and mirrored, as of
    /// --self-ensemble (docs/model.md); 1: as it is. Throws Error(input, usage).
    Teacher(const std::filesystem::path& file, int views, torch::Device device,
            torch::ScalarType type);

    /// B of the grids it reads.
    int bins() const { return config_.bins; }

    /// What it remembers of `streams` scenes before their first event window: a state per view.
    std::vector<RecurrentState> empty_states(int streams, int crop) const;

    /// Its mu of the frames that `plan` names, as Images has them; `states`, of each view, go on.
    torch::Tensor frames(const SegmentPlan& plan, const TrainingBatch& batch, int patch,
                         std::span<RecurrentState> states) const;

private:
    ModelConfig config_;
    Parameters parameters_;
    int views_;
    torch::Device device_;
};

}  // namespace eventide
