// The fused steps give the values and the gradients that torch's own operations give.
#include "apps/train/fused/fused.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace eventide {
namespace {

using torch::Tensor;
using Step = std::function<Tensor(const std::vector<Tensor>&)>;

struct Outcome {
    Tensor value;
    std::vector<Tensor> gradients;
};

/// Value, and gradients of a sum with fixed random weights, of the inputs that want one.
Outcome outcome(const Step& step, const std::vector<Tensor>& values) {
    std::vector<Tensor> inputs, leaves;
    for (const Tensor& value : values) {
        inputs.push_back(value.detach().clone());
        if (!value.requires_grad()) continue;
        inputs.back().requires_grad_(true);
        leaves.push_back(inputs.back());
    }
    const Tensor out = step(inputs);
    torch::manual_seed(9);
    const Tensor weight = torch::randn(out.sizes(), torch::kDouble);
    return {out.detach(), torch::autograd::grad({(out.to(torch::kDouble) * weight).sum()}, leaves)};
}

double difference(const Tensor& a, const Tensor& b) {
    const Tensor wide_a = a.to(torch::kDouble), wide_b = b.to(torch::kDouble);
    const double scale = wide_b.abs().max().item<double>();
    return (wide_a - wide_b).abs().max().item<double>() / std::max(scale, 1e-30);
}

void expect_same(const Step& fused, const Step& composed, const std::vector<Tensor>& values,
                 double tolerance) {
    const Outcome found = outcome(fused, values), expected = outcome(composed, values);
    ASSERT_EQ(found.value.sizes(), expected.value.sizes());
    ASSERT_EQ(found.value.scalar_type(), expected.value.scalar_type());
    EXPECT_LT(difference(found.value, expected.value), tolerance);
    ASSERT_EQ(found.gradients.size(), expected.gradients.size());
    for (std::size_t i = 0; i < found.gradients.size(); ++i) {
        EXPECT_EQ(found.gradients[i].scalar_type(), expected.gradients[i].scalar_type());
        EXPECT_LT(difference(found.gradients[i], expected.gradients[i]), tolerance)
            << "gradient " << i;
    }
}

class Fused : public testing::TestWithParam<torch::ScalarType> {
protected:
    Fused() { torch::manual_seed(4); }
    torch::ScalarType wide() const {
        return GetParam() == torch::kDouble ? torch::kDouble : torch::kFloat;
    }
    static Tensor draw(std::vector<std::int64_t> shape, torch::ScalarType type) {
        return torch::randn(shape, torch::kDouble).to(type).requires_grad_(true);
    }
    /// bfloat16 keeps 8 bits; torch's own steps round after each of several operations.
    double tolerance() const {
        return GetParam() == torch::kDouble ? 1e-12 : GetParam() == torch::kFloat ? 1e-5 : 3e-2;
    }
};

TEST_P(Fused, ResetAndUpdateOfAState) {
    const std::vector<Tensor> values{
        draw({2, 10, 7, 4}, GetParam()).sigmoid().detach().requires_grad_(true),
        draw({2, 5, 7, 4}, GetParam()), draw({2, 5, 7, 4}, wide()),
        (torch::rand({2, 1, 7, 4}) < .5).to(wide())};
    expect_same([](const auto& v) { return fused::reset_state(v[0], v[2]); },
                [](const auto& v) { return fused::composed::reset_state(v[0], v[2]); },
                {values[0], values[1].detach(), values[2]}, tolerance());
    expect_same([](const auto& v) { return fused::update_state(v[0], v[1], v[2], v[3]); },
                [](const auto& v) { return fused::composed::update_state(v[0], v[1], v[2], v[3]); },
                values, tolerance());
    expect_same([](const auto& v) { return fused::update_state(v[0], v[1], v[2], {}); },
                [](const auto& v) { return fused::composed::update_state(v[0], v[1], v[2], {}); },
                values, tolerance());
    // Update gates alone.
    const Tensor light = draw({2, 5, 7, 4}, GetParam()).sigmoid().detach().requires_grad_(true);
    expect_same([](const auto& v) { return fused::update_state(v[0], v[1], v[2], v[3]); },
                [](const auto& v) { return fused::composed::update_state(v[0], v[1], v[2], v[3]); },
                {light, values[1], values[2], values[3]}, tolerance());
}

TEST_P(Fused, TwiceTheSizeOddOrEven) {
    for (const int odd : {0, 1})
        expect_same([&](const auto& v) { return fused::up2(v[0], 10 - odd, 6); },
                    [&](const auto& v) { return fused::composed::up2(v[0], 10 - odd, 6); },
                    {draw({2, 6, 5, 3}, GetParam())}, tolerance());
}

TEST_P(Fused, FirstLayerWithItsOffsets) {
    // Several points share a sample, and some samples have no point.
    const fused::Axis y{{0, 0, 2, 4}, {0, .5, -.25, .1}}, x{{1, 1, 1, 3, 2}, {0, .2, .4, -.6, 0}};
    const std::vector<Tensor> values{draw({3, 6, 5, 4}, GetParam()), draw({3}, wide()).detach(),
                                     draw({6, 3}, GetParam())};
    expect_same(
        [&](const auto& v) { return fused::offset_layer(v[0], v[1], v[2], y, x); },
        [&](const auto& v) { return fused::composed::offset_layer(v[0], v[1], v[2], y, x); },
        values, tolerance());
}

TEST_P(Fused, CompressedGrids) {
    const Tensor grid = 40 * torch::randn({2, 9, 5, 6}, torch::kDouble);
    const Tensor few = (grid * (torch::rand({2, 9, 5, 6}) < .3)).to(wide());
    const Tensor found = fused::compressed(few, GetParam());
    ASSERT_EQ(found.scalar_type(), GetParam());
    EXPECT_LT(difference(found, fused::composed::compressed(few, GetParam())), tolerance());
}

/// What fused::members does, layer by layer: values v are the map, the offsets' weights, and the
/// weight and bias of two linear layers.
Tensor members_by_layers(const std::vector<Tensor>& v, const fused::MemberBlend& blend) {
    const auto type = v[0].scalar_type() == torch::kDouble ? torch::kDouble : torch::kFloat;
    const auto of = [&](const std::vector<double>& x) {
        return torch::tensor(x, torch::kDouble).to(type);
    };
    const auto layer = [&](const Tensor& x, int i) {
        return torch::conv2d(x, v[std::size_t(i)].to(type).unsqueeze(-1).unsqueeze(-1),
                             v[std::size_t(i) + 1].to(type));
    };
    Tensor sum;
    for (const auto& y : blend.y)
        for (const auto& x : blend.x) {
            // Layers in the wide type, as the fused ones are.
            const Tensor first =
                fused::composed::offset_layer(v[0].to(type), of(blend.dt), v[1].to(type), y, x);
            const Tensor out = layer(torch::relu(layer(first, 2)), 4);
            const Tensor mu = out.narrow(1, 0, 1);
            Tensor second = out.narrow(1, 1, 1).clamp(blend.log_sigma_min, blend.log_sigma_max);
            if (blend.squares) second = (2 * second).exp() + mu.square();
            const Tensor part =
                torch::cat({mu, second}, 1) * (of(y.weight).view({-1, 1}) * of(x.weight));
            sum = sum.defined() ? sum + part : part;
        }
    return of(blend.weight).view({-1, 1, 1, 1}) * sum;
}

/// Points on samples, between them, and beyond the last.
c10::intrusive_ptr<fused::MemberBlend> some_points(bool squares) {
    auto blend = c10::make_intrusive<fused::MemberBlend>();
    for (const std::size_t side : {0U, 1U}) {
        fused::WeightedAxis &y = blend->y[side], &x = blend->x[side];
        y.index = {0, 1 + std::int64_t(side), 4};
        y.offset = {0, .3 - double(side), .25};
        y.weight = side == 0 ? std::vector<double>{1, .7, 1} : std::vector<double>{0, .3, 0};
        for (int i = 0; i < 45; ++i) {  // more than a block
            x.index.push_back(std::min<std::int64_t>(i / 9 + std::int64_t(side), 5));
            x.offset.push_back(i / 9. - double(x.index.back()));
            x.weight.push_back(side == 0 ? 1 - i % 9 / 9. : i % 9 / 9.);
        }
    }
    blend->dt = {.4, -.6, 1};
    blend->weight = {.6, .4, 1};
    blend->log_sigma_min = -1;
    blend->log_sigma_max = 1;
    blend->squares = squares;
    return blend;
}

TEST_P(Fused, TheRenderersLayersAndTheirBlend) {
    for (const std::int64_t H : {16, 32, 64})
        for (const bool squares : {false, true}) {
            SCOPED_TRACE(std::to_string(H) + (squares ? ", second moments" : ", ln sigma"));
            const auto small = [&](std::vector<std::int64_t> shape) {
                return (draw(shape, torch::kDouble) * .3).detach().to(GetParam()).requires_grad_();
            };
            const std::vector<Tensor> values{small({3, H, 5, 6}), small({H, 3}), small({H, H}),
                                             small({H}),          small({2, H}), small({2})};
            const auto blend = some_points(squares);
            ASSERT_TRUE(fused::members_fused(values[0], {values[1], values[2], values[4]}));
            expect_same(
                [&](const auto& v) {
                    return fused::members(v[0], v[1], {v[1], v[2], v[4]}, {v[3], v[3], v[5]},
                                          blend);
                },
                [&](const auto& v) { return members_by_layers(v, *blend); }, values, tolerance());
        }
}

INSTANTIATE_TEST_SUITE_P(Types, Fused,
                         testing::Values(torch::kDouble, torch::kFloat, torch::kBFloat16),
                         [](const auto& type) { return std::string(toString(type.param)); });

}  // namespace
}  // namespace eventide
