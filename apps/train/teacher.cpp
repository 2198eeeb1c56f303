#include "apps/train/teacher.h"

#include "src/core/error.h"

#include <string>

namespace eventide {
namespace {

torch::Tensor turned(const torch::Tensor& image) {
    return image.flip({-2, -1});
}

TrainingBatch turned(const TrainingBatch& batch) {
    TrainingBatch other = batch;
    for (torch::Tensor& grid : other.grids) grid = turned(grid);
    return other;
}

/// The same patch of the turned sensor.
SegmentPlan turned(SegmentPlan plan, int crop) {
    plan.y0 = crop - 1 - plan.y0 - plan.span;
    plan.x0 = crop - 1 - plan.x0 - plan.span;
    return plan;
}

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
    for (RecurrentState& state : states) state = begin_segment(state, batch.fresh);
    torch::Tensor mu = run_segment(config_, parameters_, plan, seen, patch, states[0]).mu;
    if (views_ == 2)
        mu = (mu + turned(run_segment(config_, parameters_, turned(plan, crop), turned(seen), patch,
                                      states[1])
                              .mu)) /
             2;
    return mu.clamp(0, 1);
}

}  // namespace eventide
