// See fast_renderer.h; docs/model.md has the formulas.
#include "src/model/fast_renderer.h"

#include "src/kernels/bf16_kernels.h"
#include "src/kernels/vector_kernels.h"
#include "src/nn/typed_weights.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

namespace eventide {
namespace {

constexpr int kSide = kLatentSide;
/// Pixels that go through the layers together: two maps of 56 x 64 numbers fill half a first-level
/// cache; a multiple of the kernels' 14 and near one of their 6.
constexpr int kBlock = 56;

/// Layer 1 as a convolution over the first `codes` of the three codes, joined per pixel.
plain::ConvWeights<float> hoisted_weights(const Model& model, int codes) {
    const Tensor& first = model.weights.at("renderer.mlp.0.weight");
    const int outputs = int(first.shape[0]), inputs = int(first.shape[1]);
    const int depth = model.config.latent;
    plain::ConvWeights<float> weights{
        outputs, codes * depth, {}, model.weights.at("renderer.mlp.0.bias").values};
    for (int o = 0; o < outputs; ++o)
        for (int code = 0; code < codes; ++code)
            for (int d = 0; d < depth; ++d)
                for (int tap = 0; tap < 9; ++tap)
                    weights.weight.push_back(
                        first.values[std::size_t(o * inputs + (code * 9 + tap) * depth + d)]);
    return weights;
}

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
      height_((sensor_height + config_.latent_stride - 1) / config_.latent_stride),
      width_((sensor_width + config_.latent_stride - 1) / config_.latent_stride),
      first_(config_.mlp[0]),
      widest_(*std::ranges::max_element(config_.mlp)),
      tiles_(latent_tiles(height_, width_)) {
    const auto extents = extents_of(tiles_, 0, height_, width_);
    past_ = {hoisted_weights(model, 2), 1, false, arithmetic, extents};
    whole_ = {hoisted_weights(model, 3), 1, false, arithmetic, extents};
    tile_columns_ = int(std::ranges::count(tiles_, 0, &Tile::y0));
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
    for (PaddedMap& map : codes_) map = {height_, width_, config_.latent};
    for (auto& flags : changed_) flags.assign(tiles_.size(), 1);
    active_.reserve(tiles_.size());
    const std::size_t area = std::size_t(kSide + 2) * std::size_t(kSide + 2);
    const std::size_t for_hoisting =
        area * 3 * std::size_t(config_.latent) +
        std::max(past_.scratch_size(kSide, kSide), whole_.scratch_size(kSide, kSide));
    const std::size_t for_rows =
        std::size_t(first_) + std::size_t(kBlock) * (4 * std::size_t(widest_) + 2);
    scratch_.assign(kLanes, FloatBuffer(std::max(for_hoisting, for_rows)));
    row_sums_.resize(kLanes);
}

std::string FastRenderer::description() const {
    return std::string{"fast, "} + name_of(arithmetic_);
}

void FastRenderer::reset() noexcept {
    for (Hoisted& hoisted : hoisted_) hoisted.k = 0;
    newest_ = 0;
}

const PaddedMap* FastRenderer::code(std::int64_t k) const noexcept {
    return k >= 1 ? &codes_[LatentWindow::slot(k)] : nullptr;
}

void FastRenderer::push(std::int64_t k, const LatentMap& latent) noexcept {
    newest_ = k;
    const std::size_t slot = LatentWindow::slot(k);
    PaddedMap& mine = codes_[slot];
    const PaddedMap* before = code(k - 1);
    const Outdated outdated{histories_[slot], latent.history};
    for_each_tile(options_.parallel_for, int(tiles_.size()), [&](int, int n) {
        if (!outdated(std::size_t(n))) return;
        const Tile& tile = tiles_[std::size_t(n)];
        const auto bytes = std::size_t(tile.width()) * std::size_t(config_.latent) * sizeof(float);
        for (int y = tile.y0; y < tile.y1; ++y)
            std::memcpy(mine.at(y, tile.x0), latent.values.pixel(y, tile.x0).data(), bytes);
    });
    histories_[slot] = latent.history;

    std::vector<std::uint8_t>& changed = changed_[std::size_t(k % kChangesKept)];
    const bool comparable = before != nullptr && options_.skip_quiet;
    const Outdated since{histories_[LatentWindow::slot(k - 1)], latent.history};
    for_each_tile(options_.parallel_for, int(tiles_.size()), [&](int, int n) {
        const Tile near = tiles_[std::size_t(n)].grown(1, height_, width_);
        const auto bytes = std::size_t(near.width()) * std::size_t(config_.latent) * sizeof(float);
        bool same = comparable;
        const bool may_differ = same && around(n, since);
        for (int y = near.y0; may_differ && same && y < near.y1; ++y)
            same = std::memcmp(mine.at(y, near.x0), before->at(y, near.x0), bytes) == 0;
        changed[std::size_t(n)] = std::uint8_t(!same);
    });
}

/// Whether a tile or one beside it may have changed.
bool FastRenderer::around(int tile, const Outdated& since) const noexcept {
    const int rows = int(tiles_.size()) / tile_columns_, columns = tile_columns_;
    const int row = tile / columns, column = tile % columns;
    for (int r = std::max(0, row - 1); r <= std::min(row + 1, rows - 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min(column + 1, columns - 1); ++c)
            if (since(std::size_t(r * columns + c))) return true;
    return false;
}

/// Whether a tile of `from` already holds what event frame k would give: every code it reads is the
/// one read then.
bool FastRenderer::unchanged(const Hoisted& from, std::int64_t k, bool whole,
                             std::size_t tile) const noexcept {
    if (from.k < 1 || from.whole != whole || k < from.k) return false;
    const std::int64_t oldest = from.k,
                       newest = whole ? k + 1 : k;  // changes from.k-1 -> from.k ..
    if (newest - oldest >= kChangesKept - 1) return false;
    for (std::int64_t j = oldest; j <= newest; ++j)
        if (changed_[std::size_t(j % kChangesKept)][tile] != 0) return false;
    return true;
}

/// Brings one of the two kept maps to event frame k; never the one to `keep`.
const FastRenderer::Hoisted& FastRenderer::hoist(std::int64_t k, bool whole,
                                                 const Hoisted* keep) noexcept {
    for (const Hoisted& there : hoisted_)
        if (there.k == k && there.whole == whole) return there;
    // The one that shares most with what is wanted: of the same kind, and newest.
    const auto worth = [&](const Hoisted& there) {
        if (&there == keep) return std::int64_t{-2};
        return there.whole == whole && there.k <= k ? there.k : std::int64_t{-1};
    };
    Hoisted& to = worth(hoisted_[1]) > worth(hoisted_[0]) ? hoisted_[1] : hoisted_[0];
    if (to.sums.empty()) to.sums = {height_, width_, first_};
    active_.clear();
    for (std::size_t i = 0; i < tiles_.size(); ++i)
        if (!unchanged(to, k, whole, i)) active_.push_back(int(i));
    to.k = k;
    to.whole = whole;
    for_each_tile(options_.parallel_for, int(active_.size()), [&](int lane, int n) {
        hoist_tile(to, tiles_[std::size_t(active_[std::size_t(n)])],
                   scratch_[std::size_t(lane)].data());
    });
    return to;
}

void FastRenderer::hoist_tile(Hoisted& to, const Tile& tile, float* scratch) noexcept {
    const std::ptrdiff_t depth = config_.latent, codes = to.whole ? 3 : 2;
    const std::ptrdiff_t step = codes * depth, row = (tile.width() + 2) * step;
    const auto bytes = std::size_t(depth) * sizeof(float);
    for (std::ptrdiff_t c = 0; c < codes; ++c) {
        const PaddedMap* z = code(to.k - 1 + c);
        // The map's own border of zeros is what lies outside.
        for (int y = tile.y0 - 1; y <= tile.y1; ++y) {
            const float* from = z != nullptr ? z->at(y, tile.x0 - 1) : nullptr;
            float* out = scratch + (y - tile.y0 + 1) * row + c * depth;
            for (int x = tile.x0 - 1; x <= tile.x1; ++x, out += step) {
                if (from == nullptr) {
                    std::memset(out, 0, bytes);
                    continue;
                }
                std::memcpy(out, from, bytes);
                from += depth;
            }
        }
    }
    const PackedConv& conv = to.whole ? whole_ : past_;
    conv.run({scratch, row, to.sums.pixel(tile.y0, tile.x0).data(), std::ptrdiff_t(width_) * first_,
              first_, tile.height(), tile.width()},
             scratch + (tile.height() + 2) * row);
}

void FastRenderer::lay_out_columns(const PictureGeometry& picture) noexcept {
    if (same_columns(picture, laid_out_)) return;
    laid_out_ = picture;
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
}

void FastRenderer::render(const CodeChoice& codes, const PictureGeometry& picture, SigmaRule rule,
                          Array2<float>& intensity, Array2<float>* sigma) noexcept {
    lay_out_columns(picture);
    needs_squares_ = sigma != nullptr && rule == SigmaRule::mixture;
    const AxisSamples t = sample_time(codes.fraction, codes.next[0]);
    std::array<const Hoisted*, 2> hoisted{};
    if (t.weight[0] != 0) {
        // The later sample's map, if there already, must not be overwritten by the earlier one's.
        const Hoisted* later = nullptr;
        for (const Hoisted& there : hoisted_)
            if (t.weight[1] != 0 && there.k == codes.k + 1 && there.whole == codes.next[1])
                later = &there;
        hoisted[0] = &hoist(codes.k, codes.next[0], later);
    }
    if (t.weight[1] != 0) hoisted[1] = &hoist(codes.k + 1, codes.next[1], hoisted[0]);
    for_each_tile(options_.parallel_for, picture.part_height, [&](int lane, int row) {
        render_row(codes, picture, hoisted, row, rule, intensity.row(row).data(),
                   sigma != nullptr ? sigma->row(row).data() : nullptr, std::size_t(lane));
    });
}

void FastRenderer::render_row(const CodeChoice& codes, const PictureGeometry& picture,
                              const std::array<const Hoisted*, 2>& hoisted, int row, SigmaRule rule,
                              float* intensity, float* sigma, std::size_t lane) noexcept {
    const int width = picture.part_width;
    const auto count = std::size_t(width);
    const AxisSamples t = sample_time(codes.fraction, codes.next[0]);
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
        const float* sums = hoisted[a]->sums.pixel(y.index + int(b), 0).data();
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
