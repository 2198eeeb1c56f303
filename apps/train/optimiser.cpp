#include "apps/train/optimiser.h"

#include <algorithm>
#include <cmath>

namespace eventide {

Optimiser::Optimiser(const OptimiserSettings& given, Parameters start)
    : settings(given), parameters(std::move(start)) {
    for (const auto& [name, values] : parameters) {
        moment1[name] = torch::zeros_like(values);
        moment2[name] = torch::zeros_like(values);
        ema[name] = values.detach().clone();
    }
}

double Optimiser::step(const Parameters& gradients, double learning_rate) {
    const torch::NoGradGuard none;
    std::vector<torch::Tensor> squares;
    for (const auto& [name, g] : gradients) squares.push_back(g.square().sum().to(torch::kDouble));
    const double norm = std::sqrt(torch::stack(squares).sum().item<double>());
    if (!std::isfinite(norm)) return norm;

    ++steps;
    const double scale = std::min(1.0, settings.clip / std::max(norm, 1e-12));
    const double n = double(steps);
    const double bias1 = 1 - std::pow(settings.beta1, n), bias2 = 1 - std::pow(settings.beta2, n);
    const double decay = std::min(settings.ema_decay, (1 + n) / (10 + n));
    for (const auto& [name, raw] : gradients) {
        const torch::Tensor g = raw * scale;
        torch::Tensor &m = moment1.at(name), &v = moment2.at(name), &p = parameters.at(name);
        m.mul_(settings.beta1).add_(g, 1 - settings.beta1);
        v.mul_(settings.beta2).addcmul_(g, g, 1 - settings.beta2);
        p.addcdiv_(m / bias1, (v / bias2).sqrt().add_(settings.epsilon), -learning_rate);
        ema.at(name).lerp_(p, 1 - decay);
    }
    return norm;
}

}  // namespace eventide
