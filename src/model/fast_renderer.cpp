// See fast_renderer.h; docs/model.md has the formulas.
#include "src/model/fast_renderer.h"

#include "src/kernels/bf16_kernels.h"
#include "src/kernels/vector_kernels.h"
#include "src/nn/typed_weights.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace eventide {
namespace {

/// Pixels that go through the layers together: two maps of 56 x 64 numbers fill half a first-level
/// cache; a multiple of the kernels' 14 and near one of their 6.
constexpr int kBlock = 56;

/// [in][out] of a linear layer.
std::vector<float> transposed(const Tensor& weight) {
    const auto outputs = std::size_t(weight.shape[0]), inputs = std::size_t(weight.shape[1]);
    std::vector<float> values(weight.values.size());
    for (std::size_t o = 0; o < outputs; ++o)
        for (std::size_t i = 0; i < inputs; ++i)
            values[i * outputs + o] = weight.values[o * inputs + i];
    return values;
}

bool same_columns(const PictureGeometry& a, const PictureGeometry& b) {
    return a.width == b.width && a.x == b.x && a.part_width == b.part_width;
}

}  // namespace

FastRenderer::FastRenderer(const Model& model, int sensor_width, int sensor_height,
                           const EngineOptions& options, const Arithmetic& arithmetic)
    : config_(model.config),
      options_(options),
      arithmetic_(arithmetic),
      first_(config_.mlp[0]),
      widest_(*std::ranges::max_element(config_.mlp)),
      hoisted_(model, latent_samples(sensor_height, config_.latent_stride),
               latent_samples(sensor_width, config_.latent_stride), options, arithmetic) {
    const Tensor& first = model.weights.at("renderer.mlp.0.weight");
    const auto inputs = std::size_t(first.shape[1]);
    for (std::size_t o = 0; o < std::size_t(first_); ++o)
        for (std::size_t d = 0; d < 3; ++d)
            slope_[d].push_back(first.values[(o + 1) * inputs - 3 + d]);
    for (std::size_t i = 1; i <= config_.mlp.size(); ++i) {
        const std::string name = "renderer.mlp." + std::to_string(i);
        const Tensor& weight = model.weights.at(name + ".weight");
        const std::vector<float>& bias = model.weights.at(name + ".bias").values;
        if (i < config_.mlp.size()) {
            layers_.emplace_back(1, 1, int(weight.shape[1]), int(weight.shape[0]),
                                 transposed(weight), bias, true, arithmetic.products);
        } else {
            last_weight_ = weight.values;
            last_bias_ = bias;
        }
    }
    scratch_.assign(kLanes, FloatBuffer(std::size_t(first_) +
                                        std::size_t(kBlock) * (4 * std::size_t(widest_) + 2)));
    row_sums_.resize(kLanes);
}

std::string FastRenderer::description() const {
    return std::string{"fast, "} + name_of(arithmetic_);
}

void FastRenderer::reset() noexcept {
    hoisted_.reset();
}

void FastRenderer::push(std::int64_t k, const LatentMap& latent) noexcept {
    hoisted_.push(k, latent);
}

void FastRenderer::lay_out_columns(const PictureGeometry& picture) {
    if (same_columns(picture, laid_out_)) return;
    laid_out_ = {};  // until all is there
    for (std::size_t side = 0; side < 2; ++side) {
        columns_.pixel[side].clear();
        columns_.column[side].clear();
        columns_.offset[side].clear();
        columns_.weight[side].clear();
        for (int i = 0; i < picture.part_width; ++i) {
            const AxisSamples x = sample_axis(picture.x + i, picture.width, picture.sensor_width,
                                              config_.latent_stride, config_.blend);
            if (x.weight[side] == 0) continue;
            columns_.pixel[side].push_back(i);
            columns_.column[side].push_back(x.index + int(side));
            columns_.offset[side].push_back(float(x.offset[side]));
            columns_.weight[side].push_back(float(x.weight[side]));
        }
    }
    for (FloatBuffer& sums : row_sums_) sums.resize(3 * std::size_t(picture.part_width));
    laid_out_ = picture;
}

AxisSamples FastRenderer::time_samples(const CodeChoice& codes) const noexcept {
    const bool fades = config_.live_edge == LiveEdge::fade && codes.k > 1;
    return sample_time(codes.fraction, codes.next[0], fades);
}

void FastRenderer::render(const CodeChoice& codes, const PictureGeometry& picture, SigmaRule rule,
                          Array2<float>& intensity, Array2<float>* sigma) noexcept {
    lay_out_columns(picture);
    needs_squares_ = sigma != nullptr && rule == SigmaRule::mixture;
    const AxisSamples t = time_samples(codes);
    std::array<const HoistedLayer::Sums*, 2> hoisted{};  // of the samples with a weight
    const std::int64_t k = codes.k + t.index;
    // What a fading live edge shows of the event frame before was made without z_k.
    const bool whole = t.index == 0 && codes.next[0], next_whole = t.index == 0 && codes.next[1];
    if (t.weight[1] == 0)
        hoisted[0] = &hoisted_.at(k, whole);
    else if (t.weight[0] == 0)
        hoisted[1] = &hoisted_.at(k + 1, next_whole);
    else
        hoisted = hoisted_.pair(k, whole, next_whole);
    for_each_tile(options_.parallel_for, picture.part_height, [&](int lane, int row) {
        render_row(codes, picture, hoisted, row, rule, intensity.row(row).data(),
                   sigma != nullptr ? sigma->row(row).data() : nullptr, std::size_t(lane));
    });
}

void FastRenderer::render_row(const CodeChoice& codes, const PictureGeometry& picture,
                              const std::array<const HoistedLayer::Sums*, 2>& hoisted, int row,
                              SigmaRule rule, float* intensity, float* sigma,
                              std::size_t lane) noexcept {
    const int width = picture.part_width;
    const auto count = std::size_t(width);
    const AxisSamples t = time_samples(codes);
    const AxisSamples y = sample_axis(picture.y + row, picture.height, picture.sensor_height,
                                      config_.latent_stride, config_.blend);
    float* scratch = scratch_[lane].data();
    float* blended = row_sums_[lane].data();  // mu, ln sigma, sigma^2 + mu^2
    std::fill_n(blended, 3 * count, 0.0F);
    float* base = scratch;
    for (std::size_t n = 0; n < 4; ++n) {
        const std::size_t a = n / 2, b = n % 2;
        const double weight = t.weight[a] * y.weight[b];
        if (weight == 0) continue;
        for (std::size_t o = 0; o < std::size_t(first_); ++o)
            base[o] = slope_[0][o] * float(t.offset[a]) + slope_[2][o] * float(y.offset[b]);
        const float* sums = hoisted[a]->values.pixel(y.index + int(b), 0).data();
        for (std::size_t side = 0; side < 2; ++side)
            evaluate({sums, base, float(weight), side}, blended, width, scratch + first_);
    }
    std::copy_n(blended, count, intensity);
    if (sigma == nullptr) return;
    for (std::size_t i = 0; i < count; ++i) {
        const float mu = blended[i];
        const float plain = rule == SigmaRule::log_blend
                                ? std::exp(blended[count + i])
                                : std::sqrt(std::max(blended[2 * count + i] - mu * mu, 0.0F));
        sigma[i] = config_.sigma_scale * plain;
    }
}

void FastRenderer::evaluate(const Member& member, float* blended, int width,
                            float* scratch) const noexcept {
    const std::vector<int>& pixel = columns_.pixel[member.side];
    const std::vector<float>& share = columns_.weight[member.side];
    const auto count = std::size_t(width);
    float* activations = scratch;
    float* outputs = activations + kBlock * widest_;
    float* room = outputs + 2 * kBlock;
    for (std::size_t begin = 0; begin < pixel.size(); begin += kBlock) {
        const int pixels = int(std::min<std::size_t>(kBlock, pixel.size() - begin));
        vector_kernels().offset_rows({member.sums, columns_.column[member.side].data() + begin,
                                      columns_.offset[member.side].data() + begin, member.base,
                                      slope_[1].data(), pixels, first_, activations});
        const float* last = run_layers(activations, pixels, room);
        vector_kernels().two_outputs(last, last_weight_.data(), last_bias_.data(), pixels,
                                     config_.mlp.back(), outputs);
        for (std::size_t j = 0; j < std::size_t(pixels); ++j) {
            const auto i = std::size_t(pixel[begin + j]);
            const float weight = member.weight * share[begin + j], mu = outputs[2 * j];
            const float log_sigma =
                std::clamp(outputs[2 * j + 1], config_.log_sigma_min, config_.log_sigma_max);
            blended[i] += weight * mu;
            blended[count + i] += weight * log_sigma;
            if (needs_squares_)
                blended[2 * count + i] += weight * (std::exp(2 * log_sigma) + mu * mu);
        }
    }
}

const float* FastRenderer::run_layers(const float* activations, int pixels,
                                      float* room) const noexcept {
    const std::ptrdiff_t block = std::ptrdiff_t(kBlock) * widest_;
    const float* in = activations;
    float* out = room;
    for (const PackedWeights& layer : layers_) {
        const void* numbers = in;
        if (const Bf16Kernels* bf16 = layer.bf16()) {
            auto* narrow = reinterpret_cast<std::uint32_t*>(room + 2 * block);
            bf16->narrow(in, std::size_t(pixels), layer.channels(), narrow);
            numbers = narrow;
        }
        layer.run(numbers, 0, layer.step(), pixels, out, layer.outputs());
        in = out;
        out = out == room ? room + block : room;
    }
    return in;
}

}  // namespace eventide
