#include "apps/train/validation.h"

#include "src/core/error.h"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace eventide {

Validation::Validation(const ValidationSettings& settings, DataSettings data,
                       std::shared_ptr<const TextureLibrary> textures, torch::Device device)
    : data_(std::move(data)) {
    data_.crop = data_.patch = settings.crop;
    data_.event_windows = settings.event_windows;
    data_.rendered = settings.event_windows;  // fewer would be any of them, some that count nothing
    data_.episode = {double(settings.event_windows), double(settings.event_windows)};
    data_.whole_probability = 1;
    data_.seed = settings.seed;
    data_.teacher_bins = 0;  // nobody is taught by them
    plan_ = segment_plan(data_, 0);
    for (int scene = 0; scene < settings.scenes; ++scene) {
        const StreamSegment segment = SceneStream{data_, textures, {.stream = scene}, 0}.next();
        scenes_.push_back(to_batch({&segment, 1}, device));
    }
}

Images Validation::render_scene(const ModelConfig& config, const Parameters& parameters,
                                std::size_t scene, int lookahead) const {
    const TrainingBatch& batch = scenes_[scene];
    const torch::Tensor& grid = batch.grids[0];
    RecurrentState recurrent = empty_recurrent_state(config, 1, grid.size(2), grid.size(3),
                                                     grid.options().dtype(torch::kFloat));
    SegmentPlan plan = plan_;
    std::fill(plan.lookahead.begin(), plan.lookahead.end(), lookahead);
    return run_segment(config, parameters, plan, batch, data_.patch, recurrent);
}

Validation::Scores Validation::judge(const ModelConfig& config, const Parameters& parameters,
                                     int lookahead, const LossWeights& weights,
                                     const Perceptual* perceptual) const {
    const torch::NoGradGuard none;
    Scores scores;
    for (std::size_t i = 0; i < scenes_.size(); ++i) {
        const Images images = render_scene(config, parameters, i, lookahead);
        // A quarter of the images is enough for LPIPS to rank by.
        const LossTerms terms = loss(images, weights, perceptual, data_.rendered / 4);
        const double share = 1 / double(scenes_.size());
        scores.score += share * terms.total.item<double>();
        for (std::size_t k = 0; k < scores.means.size(); ++k)
            scores.means[k] += share * terms.means[k];
    }
    return scores;
}

double Validation::sigma_scale(const ModelConfig& config, const Parameters& parameters,
                               int lookahead) const {
    const torch::NoGradGuard none;
    std::vector<torch::Tensor> ratios;
    for (std::size_t i = 0; i < scenes_.size(); ++i) {
        const Images p = render_scene(config, parameters, i, lookahead);
        const auto counted = (p.weight > 0).nonzero().squeeze(1);
        const auto ratio = (p.truth - p.mu.clamp(0, 1)).abs() * (-p.log_sigma).exp();
        ratios.push_back(ratio.index_select(0, counted).flatten());
    }
    const torch::Tensor all = std::get<0>(torch::cat(ratios).sort());
    if (all.size(0) == 0) return 1;  // scenes too short for a frame that counts
    return all[std::int64_t(0.8 * double(all.size(0) - 1))].item<double>() / 1.2816;
}

void Validation::write_sheet(const std::filesystem::path& path, const ModelConfig& config,
                             const Parameters& parameters, int lookahead) const {
    const torch::NoGradGuard none;
    std::vector<torch::Tensor> rows;
    for (std::size_t i = 0; i < scenes_.size(); ++i) {
        const Images p = render_scene(config, parameters, i, lookahead);
        rows.push_back(torch::cat({p.truth[-1], p.mu[-1], 2 * p.log_sigma[-1].exp()}, 1));
    }
    const torch::Tensor sheet = (torch::cat(rows, 0) * 255)
                                    .round()
                                    .clamp(0, 255)
                                    .to(torch::kCPU, torch::kByte)
                                    .contiguous();
    std::ofstream file{path, std::ios::binary};
    file << "P5\n" << sheet.size(1) << " " << sheet.size(0) << "\n255\n";
    file.write(reinterpret_cast<const char*>(sheet.data_ptr<std::uint8_t>()), sheet.numel());
    if (!file) throw Error(ErrorKind::failed, path.string() + ": cannot be written");
}

}  // namespace eventide
