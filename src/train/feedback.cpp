#include "src/train/feedback.h"

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

/// [points][samples]: rows that interpolate linearly; outside, the nearest sample.
torch::Tensor interpolation(const std::vector<double>& points, std::int64_t samples,
                            torch::TensorOptions options) {
    torch::Tensor rows = torch::zeros({std::int64_t(points.size()), samples});
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double p = std::clamp(points[i], 0.0, double(samples - 1));
        const auto low = std::int64_t(p), high = std::min(low + 1, samples - 1);
        rows[std::int64_t(i)][low] += 1 - (p - double(low));
        rows[std::int64_t(i)][high] += p - double(low);
    }
    return rows.to(options);
}

/// What the codes of each task started from, at its instant: [N * tasks][rows][columns], grey
/// included. Weights in time are those of the codes (docs/model.md, "Centres").
torch::Tensor base(const std::vector<FedPictures>& pictures, const PatchGrid& points) {
    std::vector<torch::Tensor> all;
    for (const FedPictures& fed : pictures) {
        const torch::Tensor f = fed.f.view({-1, 1, 1, 1});
        all.push_back(fed.end.defined() ? (1 - f) * fed.start + f * fed.end : fed.start);
    }
    const torch::Tensor maps = torch::cat(all, 0).squeeze(1);
    const auto wy = interpolation(points.y, maps.size(1), maps.options());
    const auto wx = interpolation(points.x, maps.size(2), maps.options());
    return torch::matmul(torch::matmul(wy, maps), wx.t()) + kFeedbackGrey;
}

}  // namespace

Parameters with_feedback(Parameters parameters, Feedback feedback) {
    if (feedback == Feedback::none) return parameters;
    const torch::NoGradGuard none;
    torch::Tensor& first = parameters.at("encoder.in.weight");
    const double bound = std::sqrt(6.0 / double(first[0].numel()));
    first =
        torch::cat({first, torch::empty_like(first.narrow(1, 0, 1)).uniform_(-bound, bound)}, 1);
    first.set_requires_grad(true);
    if (feedback == Feedback::input) return parameters;
    int last = 0;
    while (parameters.count("renderer.mlp." + std::to_string(last + 1) + ".bias") != 0) ++last;
    parameters.at("renderer.mlp." + std::to_string(last) + ".bias")[0] = 0.0;  // no change at first
    if (feedback == Feedback::physical)
        parameters["feedback.k"] = torch::full({1}, -1.5, first.options()).set_requires_grad(true);
    return parameters;
}

torch::Tensor with_picture(const torch::Tensor& grid, const torch::Tensor& picture) {
    return torch::cat({grid, picture.to(grid.scalar_type())}, 1);
}

Rendered apply_feedback(Feedback feedback, const Parameters& parameters, const Rendered& out,
                        const std::vector<FedPictures>& pictures, const PatchGrid& points) {
    if (feedback == Feedback::none || feedback == Feedback::input) return out;
    const torch::Tensor p = base(pictures, points);
    if (feedback == Feedback::change) return {p + out.mu, out.log_sigma};
    // Light p + k, k > 0, so that black can become brighter; sigma grows with the light.
    const auto k = parameters.at("feedback.k").to(p.scalar_type()).exp();
    return {(p + k) * out.mu.clamp(-4, 4).exp() - k, out.log_sigma + (p + k).log()};
}

torch::Tensor next_picture(Feedback feedback, const ModelConfig& config,
                           const Parameters& parameters, const torch::Tensor& previous,
                           const torch::Tensor& current, const torch::Tensor& picture) {
    const torch::NoGradGuard none;
    PatchGrid points;
    for (std::int64_t y = 0; y < current.size(2); ++y) points.y.push_back(double(y));
    for (std::int64_t x = 0; x < current.size(3); ++x) points.x.push_back(double(x));
    const torch::Tensor end = torch::ones({current.size(0)}, picture.options());
    const Rendered out = render(config, parameters, {{previous, current, {}, {}, end}}, points);
    const auto next = apply_feedback(feedback, parameters, out, {{picture, {}, end}}, points);
    return next.mu.clamp(0, 1).unsqueeze(1) - kFeedbackGrey;
}

}  // namespace eventide
