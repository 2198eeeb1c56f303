#include "apps/train/data/batch.h"

#include <algorithm>
#include <cstring>
#include <future>

namespace eventide {

RecurrentState empty_recurrent_state(const ModelConfig& config, std::int64_t streams,
                                     std::int64_t height, std::int64_t width,
                                     torch::TensorOptions options) {
    const std::int64_t s = config.latent_stride;
    return {
        empty_state(config, streams, height, width, options),
        torch::zeros({streams, config.latent, (height + s - 1) / s, (width + s - 1) / s}, options)
            .contiguous(torch::MemoryFormat::ChannelsLast)};
}

RecurrentState begin_segment(const RecurrentState& recurrent, const std::vector<bool>& fresh) {
    const std::vector<std::uint8_t> flags(fresh.begin(), fresh.end());
    const auto anew =
        torch::tensor(flags).view({-1, 1, 1, 1}).to(recurrent.latent.device(), torch::kBool);
    // Filled, not multiplied by 0: what is no number would stay none.
    const auto begun = [&](const torch::Tensor& map) {
        return map.detach().clone().masked_fill_(anew, 0);
    };
    RecurrentState next{{}, begun(recurrent.latent)};
    for (const torch::Tensor& map : recurrent.state) next.state.push_back(begun(map));
    return next;
}

torch::Tensor to_torch(std::span<const Array3<float>* const> grids, torch::Device device) {
    const Array3<float>& first = *grids[0];
    const auto n = std::int64_t(grids.size());
    torch::Tensor all = torch::empty({n, first.height(), first.width(), first.channels()},
                                     torch::TensorOptions{}.pinned_memory(device.is_cuda()));
    float* out = all.data_ptr<float>();
    for (const Array3<float>* grid : grids)
        out = std::copy(grid->values().begin(), grid->values().end(), out);
    // The binner's layout is torch's channels-last, seen through another order of indices.
    return all.to(device, /*non_blocking=*/true).permute({0, 3, 1, 2});
}

namespace {

/// One tensor per event window, of all streams.
std::vector<torch::Tensor> to_torch(std::span<const StreamSegment> segments,
                                    std::vector<Array3<float>> StreamSegment::*grids,
                                    torch::Device device) {
    const auto window = [&](std::size_t k) {
        std::vector<const Array3<float>*> beside;
        for (const StreamSegment& segment : segments) beside.push_back(&(segment.*grids)[k]);
        return to_torch(beside, device);
    };
    // A GPU's large batches are copied window beside window.
    const auto when = device.is_cuda() ? std::launch::async : std::launch::deferred;
    std::vector<std::future<torch::Tensor>> windows;
    for (std::size_t k = 0; k < (segments[0].*grids).size(); ++k)
        windows.push_back(std::async(when, window, k));
    std::vector<torch::Tensor> copied;
    for (auto& one : windows) copied.push_back(one.get());
    return copied;
}

}  // namespace

TrainingBatch to_batch(std::span<const StreamSegment> segments, torch::Device device) {
    TrainingBatch batch;
    const StreamSegment& like = segments[0];
    for (const StreamSegment& segment : segments) batch.fresh.push_back(segment.fresh);
    batch.grids = to_torch(segments, &StreamSegment::grids, device);
    batch.teacher_grids = to_torch(segments, &StreamSegment::teacher_grids, device);
    const auto tasks = std::int64_t(like.f.size()), streams = std::int64_t(segments.size());
    const int patch = like.truth[0].height();
    batch.truth = torch::empty({tasks * streams, patch, patch});
    float* out = batch.truth.data_ptr<float>();
    std::vector<float> weight;
    for (std::size_t i = 0; i < like.f.size(); ++i) {
        std::vector<float> f;
        for (const StreamSegment& segment : segments) {
            f.push_back(segment.f[i]);
            weight.push_back(segment.weight[i]);
            out =
                std::copy(segment.truth[i].values().begin(), segment.truth[i].values().end(), out);
        }
        batch.f.push_back(torch::tensor(f).to(device));
    }
    batch.truth = batch.truth.to(device);
    batch.weight = torch::tensor(weight).to(device);
    return batch;
}

Images run_segment(const ModelConfig& config, const Parameters& parameters, const SegmentPlan& plan,
                   const TrainingBatch& batch, int patch, RecurrentState& recurrent) {
    const auto type = parameters.begin()->second.scalar_type();
    std::vector<torch::Tensor> z{recurrent.latent.to(type)};  // z[k + 1] belongs to frame k
    for (const torch::Tensor& grid : batch.grids) {
        EncodedGrid encoded = encode(config, parameters, grid, recurrent.state);
        recurrent.state = std::move(encoded.state);
        z.push_back(encoded.latent.to(type));
    }
    recurrent.latent = z.back().to(recurrent.latent.scalar_type());

    std::vector<RenderTask> tasks;
    for (std::size_t i = 0; i < batch.f.size(); ++i) {
        const std::size_t k = std::size_t(plan.first_rendered) + i;
        // Codes past the segment's end are not known, whatever the lookahead.
        const auto code = [&](std::size_t ahead) {
            const bool known = int(ahead) <= plan.lookahead[i] && k + 1 + ahead < z.size();
            return known ? z[k + 1 + ahead] : torch::Tensor{};
        };
        tasks.push_back({z[k], z[k + 1], code(1), code(2), batch.f[i]});
        if (config.live_edge == LiveEdge::fade && k > 0) tasks.back().before = z[k - 1];
    }
    const double s = config.latent_stride;
    const PatchGrid points = patch_grid(plan.y0 / s, plan.x0 / s, plan.span / s, patch);
    const Rendered out = render(config, parameters, tasks, points);
    return {out.mu, out.log_sigma, batch.truth, batch.weight, std::int64_t(batch.fresh.size())};
}

}  // namespace eventide
