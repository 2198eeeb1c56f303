#include "apps/train/teacher.h"

#include "src/core/error.h"
#include "src/model/mirrors.h"

#include <string>

namespace eventide {
namespace {

/// What one of the mirrored networks sees.
struct View {
    Mirror axes;

    torch::Tensor of(const torch::Tensor& image) const {
        std::vector<std::int64_t> dimensions;
        if (axes.x) dimensions.push_back(-1);
        if (axes.y) dimensions.push_back(-2);
        return dimensions.empty() ? image : image.flip(dimensions);
    }
    TrainingBatch of(TrainingBatch batch) const {
        for (torch::Tensor& grid : batch.grids) grid = of(grid);
        return batch;
    }
    /// The same patch of the mirrored sensor.
    SegmentPlan of(SegmentPlan plan, int crop) const {
        if (axes.x) plan.x0 = crop - 1 - plan.x0 - plan.span;
        if (axes.y) plan.y0 = crop - 1 - plan.y0 - plan.span;
        return plan;
    }
};

}  // namespace

Teacher::Teacher(const std::filesystem::path& file, int views, torch::Device device,
                 torch::ScalarType type)
    : views_(views), device_(device) {
    const Model model = load_model(file);
    config_ = model.config;
    // The pixels of a turned map of half the size would lie elsewhere.
    if (config_.latent_stride != 1)
        throw Error(ErrorKind::usage, "--teacher " + file.string() +
                                          ": expected a model of latent_stride 1, found " +
                                          std::to_string(config_.latent_stride));
    const torch::NoGradGuard none;
    parameters_ = cast(to_parameters(model.weights, device), type);
}

std::vector<RecurrentState> Teacher::empty_states(int streams, int crop) const {
    return {std::size_t(views_), empty_recurrent_state(config_, streams, crop, crop, {device_})};
}

torch::Tensor Teacher::frames(const SegmentPlan& plan, const TrainingBatch& batch, int patch,
                              std::span<RecurrentState> states) const {
    const torch::NoGradGuard none;
    TrainingBatch seen = batch;
    if (!batch.teacher_grids.empty()) seen.grids = batch.teacher_grids;
    const int crop = int(seen.grids[0].size(-1));
    torch::Tensor sum;
    for (std::size_t n = 0; n < states.size(); ++n) {
        const View view{kMirrors.at(n)};
        states[n] = begin_segment(states[n], batch.fresh);
        const Images shown =
            run_segment(config_, parameters_, view.of(plan, crop), view.of(seen), patch, states[n]);
        const torch::Tensor mu = view.of(shown.mu);
        sum = sum.defined() ? sum + mu : mu;
    }
    return (sum / double(states.size())).clamp(0, 1);
}

}  // namespace eventide
