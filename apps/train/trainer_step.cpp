// One step: the segments of all shares, their gradients, and how far the weights go down them.
#include "apps/train/device.h"
#include "apps/train/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace eventide {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

double Trainer::learning_rate() const {
    const double done = options_.steps > 0 ? double(progress_.segment) / options_.steps
                                           : progress_.elapsed_minutes / options_.minutes;
    const double rise = std::min(1.0, double(progress_.segment + 1) / (options_.warm_up + 1));
    const double falling =
        std::clamp((done - options_.constant_share) / (1 - options_.constant_share), 0.0, 1.0);
    const double cosine = 0.5 * (1 + std::cos(std::numbers::pi * falling));
    return options_.learning_rate * rise *
           (options_.final_rate + (1 - options_.final_rate) * cosine);
}

/// Waits for the simulator; one batch per share.
std::vector<TrainingBatch> Trainer::load() {
    const std::vector<StreamSegment> segments = feed_->next();
    const auto streams = std::size_t(options_.streams);
    std::vector<TrainingBatch> batches;
    for (std::size_t i = 0; i < segments.size(); i += streams)
        batches.push_back(to_batch(std::span{segments}.subspan(i, streams), device_));
    return batches;
}

/// A GPU computes a step while the processor copies what the next one reads.
std::vector<TrainingBatch> Trainer::next_batches() {
    std::vector<TrainingBatch> batches = upcoming_.valid() ? upcoming_.get() : load();
    if (device_.is_cuda()) upcoming_ = std::async(std::launch::async, [this] { return load(); });
    return batches;
}

/// The truth, and so much of the teacher's frames as its share is.
torch::Tensor Trainer::taught(const torch::Tensor& truth, const TrainingBatch& batch,
                              const SegmentPlan& plan, int place) {
    const auto views = std::size_t(options_.teacher_views);
    const auto states =
        std::span{progress_.teacher_states}.subspan(std::size_t(place) * views, views);
    return truth.lerp(teacher_->frames(plan, batch, options_.data.patch, states),
                      options_.teacher_share);
}

/// `place` in recurrent_states: of the group whose turn it is and of the thread.
Trainer::Share Trainer::run_share(const TrainingBatch& batch, const SegmentPlan& plan, int place) {
    at::set_num_threads(1);  // libgomp keeps the number per thread
    RecurrentState& recurrent = progress_.recurrent_states[std::size_t(place)];
    recurrent = begin_segment(recurrent, batch.fresh);
    const Parameters narrow =
        type_ == torch::kFloat ? optimiser_.parameters : cast(optimiser_.parameters, type_);
    Images images =
        run_segment(options_.model, narrow, plan, batch, options_.data.patch, recurrent);
    if (teacher_ != nullptr) images.taught = taught(images.truth, batch, plan, place);
    Share share;
    const bool looks = options_.lpips_on_pixels || !plan.on_pixels;
    share.terms =
        loss(images, options_.loss, looks ? perceptual_.get() : nullptr, options_.lpips_frames);
    std::vector<torch::Tensor> leaves;
    std::vector<std::string> names;
    for (const auto& [name, values] : optimiser_.parameters) {
        if (!values.requires_grad()) continue;
        leaves.push_back(values);
        names.push_back(name);
    }
    const auto gradients = torch::autograd::grad({share.terms.total}, leaves, {}, {}, false,
                                                 /*allow_unused=*/true);
    for (std::size_t i = 0; i < names.size(); ++i)
        share.gradients[names[i]] =
            gradients[i].defined() ? gradients[i] : torch::zeros_like(leaves[i]);
    recurrent = {detach(recurrent.state), recurrent.latent.detach()};
    return share;
}

/// Each on a thread of its own; throws what one of them threw.
std::vector<Trainer::Share> Trainer::run_shares(const std::vector<TrainingBatch>& batches,
                                                const SegmentPlan& plan, int first_place) {
    const auto work = [&](std::size_t i) {
        return run_share(batches[i], plan, first_place + int(i));
    };
    std::vector<std::future<Share>> others;
    for (std::size_t i = 1; i < batches.size(); ++i)
        others.push_back(std::async(std::launch::async, work, i));
    std::vector<Share> shares{work(0)};
    for (std::future<Share>& other : others) shares.push_back(other.get());
    return shares;
}

Trainer::Share Trainer::mean_of(std::vector<Share> shares) {
    Share mean = std::move(shares[0]);
    const auto n = double(shares.size());
    for (auto& [name, g] : mean.gradients) {
        for (std::size_t i = 1; i < shares.size(); ++i) g = g + shares[i].gradients.at(name);
        g = g / n;
    }
    for (std::size_t k = 0; k < mean.terms.means.size(); ++k) {
        for (std::size_t i = 1; i < shares.size(); ++i)
            mean.terms.means[k] += shares[i].terms.means[k];
        mean.terms.means[k] /= n;
    }
    return mean;
}

void Trainer::step() {
    const auto start = Clock::now();
    const double cpu_start = cpu_seconds();
    const SegmentPlan plan = segment_plan(options_.data, progress_.segment);
    const std::vector<TrainingBatch> batches = next_batches();
    const int first_place = int(progress_.segment % options_.groups) * options_.threads;
    Share mean = mean_of(run_shares(batches, plan, first_place));
    Parameters& gradients = mean.gradients;
    if (const auto of_inputs = gradients.find("encoder.in.weight"); of_inputs != gradients.end())
        of_inputs->second = of_inputs->second * input_mask_;  // what starts at 0 stays there
    const double rate = learning_rate(), norm = optimiser_.step(gradients, rate);
    if (!std::isfinite(norm))  // a state that has run away must not spoil the next segments
        for (RecurrentState& recurrent : std::span{progress_.recurrent_states}.subspan(
                 std::size_t(first_place), batches.size()))
            recurrent =
                begin_segment(recurrent, std::vector<bool>(std::size_t(options_.streams), true));
    ++progress_.segment;
    const double seconds = seconds_since(start);
    progress_.elapsed_minutes +=
        (options_.clock == "cpu" ? cpu_seconds() - cpu_start : seconds) / 60;
    const std::int64_t skipped = progress_.segment - optimiser_.steps;
    log_.step(mark(), mean.terms, {rate, norm, seconds, skipped});
}

}  // namespace eventide
