// The model's stages, with double precision walking along.
#include "apps/cli/stress/watched_stages.h"

#include "apps/cli/stress/worst.h"
#include "src/model/latent_codes.h"
#include "src/model/latent_window.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace eventide::stress {

Judge::Judge(const Model& model, int width, int height, const Sampling& sampling)
    : config_{model.config},
      width_{width},
      height_{height},
      sampling_{sampling},
      network_{make_double(model, height, width)},
      renderer_{model} {}

bool Judge::judges(std::uint64_t window) const {
    return window < sampling_.first || window % sampling_.period < sampling_.segment;
}

void Judge::before_encoding(const Encoder& encoder) {
    const bool judged = judging_;
    judging_ = judges(windows_);
    if (!judging_ || judged) return;
    const TensorFile state = encoder.state();
    network_->go_on_from(state);
    note_state(state);
}

void Judge::encoded(const VoxelGrid& grid, const LatentMap& latent) {
    ++windows_;
    if (grid.reset_before) known_.clear();
    if (!judging_ && !judges(windows_) && !judges(windows_ + 1)) {  // nothing will read it
        known_.clear();
        return;
    }
    // A copy only where they are bf16: sensors may be large.
    const Array3<float> decoded =
        latent.is_bf16 ? codes_in_float(latent, config_.latent) : Array3<float>{};
    const Array3<float>& given = latent.is_bf16 ? decoded : latent.values;
    Array3<double> codes = judging_ ? network_->step(in_double(grid.values)) : in_double(given);
    if (judging_) codes_.add(given.values(), codes.values());
    known_.push_back({grid.window, std::move(codes)});
    if (known_.size() > std::size_t(LatentWindow::kLatentsKept)) known_.pop_front();
}

void Judge::reset() {
    network_->reset();
    known_.clear();
}

void Judge::note_state(const TensorFile& state) {
    for (std::size_t l = 0; l < config_.recurrent.size(); ++l) {
        const auto found = state.tensors.find("h." + std::to_string(l));
        if (found == state.tensors.end() || config_.recurrent[l] == 0) continue;
        for (const float h : found->second.values)
            largest_state_ = worst_of(largest_state_, std::abs(double(h)));
    }
}

namespace {

/// px: as much of a frame as is worth its time.
constexpr int kPatch = 12;

/// A part of the frame, another one each time; the corners first.
FrameGeometry part_of(const RenderRequest& request, int width, int height, const Frame& frame,
                      std::uint64_t n) {
    FrameGeometry part;
    part.sensor_width = width;
    part.sensor_height = height;
    part.width = request.width == 0 ? width : request.width;
    part.height = request.height == 0 ? height : request.height;
    part.part_width = std::min(kPatch, frame.intensity.width());
    part.part_height = std::min(kPatch, frame.intensity.height());
    const int free_x = frame.intensity.width() - part.part_width;
    const int free_y = frame.intensity.height() - part.part_height;
    const std::uint64_t mixed = n * 0x9e3779b97f4a7c15ULL;
    part.x = n < 4 ? int(n % 2) * free_x : int(mixed >> 33) % (free_x + 1);
    part.y = n < 4 ? int(n / 2) * free_y : int(mixed >> 17 & 0x7fffffff) % (free_y + 1);
    return part;
}

Array2<float> cut(const Array2<float>& map, const FrameGeometry& part) {
    Array2<float> cut{part.part_height, part.part_width};
    for (int y = 0; y < part.part_height; ++y)
        for (int x = 0; x < part.part_width; ++x) cut(y, x) = map(part.y + y, part.x + x);
    return cut;
}

}  // namespace

void Judge::rendered(SensorTime t, const Window& window, const RenderRequest& request,
                     const Frame& frame) {
    if (!judging_ || rendered_++ % sampling_.frames_every != 0) return;
    const auto here = std::ranges::find(known_, window, &Known::window);
    if (here == known_.end()) return;
    DoubleRenderer::Codes codes{};
    for (int n = -2; n <= 2; ++n) {
        const std::ptrdiff_t at = here - known_.begin() + n;
        const bool there = at >= 0 && at < std::ptrdiff_t(known_.size());
        codes[std::size_t(n + 2)] = there ? &known_[std::size_t(at)].codes : nullptr;
    }
    const auto width = double(window.width().count());
    const double past = double(std::max<std::int64_t>((t - window.begin).count(), 1));
    FrameGeometry part = part_of(request, width_, height_, frame, rendered_ - 1);
    const Array2<float> intensity = cut(frame.intensity, part);
    const Array2<float> sigma = frame.sigma.empty() ? Array2<float>{} : cut(frame.sigma, part);
    part.x += request.region.x;
    part.y += request.region.y;
    const auto exact = renderer_.render(codes, width > 0 ? past / width : 1, part,
                                        request.sigma_rule.value_or(config_.sigma_rule));
    frames_.add(intensity.values(), exact.intensity.values());
    if (!sigma.empty()) frames_.add(sigma.values(), exact.sigma.values());
}

void JudgedEncodeStage::step(const VoxelGrid& grid, LatentMap& latent) noexcept {
    if (judge_ != nullptr) judge_->before_encoding(encoder_);
    encoder_.encode(grid, latent);
    if (judge_ != nullptr) judge_->encoded(grid, latent);
}

void JudgedEncodeStage::reset() noexcept {
    encoder_.reset();
    if (judge_ != nullptr) judge_->reset();
}

}  // namespace eventide::stress
