// See thesis_encoder.h; docs/model.md has the formulas.
//
// Full size but where it says half. Behind each norm is an elu; a norm looks at all tiles' sums
// before any tile goes on:
//
//     grid --in--> raw --norm0--> x0 --gru.0--> h0 --res.0--> raw --norm1--> inner
//     inner --res.1--> raw --norm2, + h0--> x2 --down--> half --gru.1--> h1 (half) --up2--> x3
//     [x3; x2; x0] --head.0--> raw --norm3--> y0 --head.1--> raw --norm4, + y0--> y1
//     y1 --head.2--> codes
//
// A worker's scratch is the largest of: a tile with its rim of up to three maps and what a
// convolution needs; a GRU's; the half GRU's, then `down` of its tile and 2 more on each side.
#include "src/model/encode/thesis_encoder.h"

#include "src/kernels/vector_kernels.h"
#include "src/nn/upsample2x.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace eventide {
namespace {

/// Full-size tiles are those in which changes of codes are told.
constexpr int kSide = kLatentSide, kHalfSide = 24;

}  // namespace

ThesisEncoder::ThesisEncoder(const Model& model, int height, int width,
                             const EngineOptions& options, const Backend& backend)
    : backend_(backend),
      channels_(model.config.widths[0]),
      latent_(height, width),
      half_tiles_(tiles_of((height + 1) / 2, (width + 1) / 2, kHalfSide)),
      runner_(options.parallel_for, options.skip_quiet) {
    const Tensors& w = model.weights;
    const Extent full{height, width}, half{(height + 1) / 2, (width + 1) / 2};
    const auto conv = [&](const std::string& name, const std::vector<int>& sources = {}) {
        return PackedConv{plain::conv_weights<float>(w, "encoder." + name), 1,      false, backend_,
                          extents_of(latent_.tiles(), 0, height, width),    sources};
    };
    in_ = conv("in");
    down_ = {plain::conv_weights<float>(w, "encoder.down"), 2, false, backend_,
             extents_of(half_tiles_, 2, half.height, half.width)};
    for (int i = 0; i < 2; ++i) res_[i] = conv("res." + std::to_string(i));
    for (int i = 0; i < 3; ++i)
        head_[i] = conv("head." + std::to_string(i),
                        i == 0 ? std::vector<int>(3, channels_) : std::vector<int>{});
    for (int i = 0; i < 5; ++i)
        norms_.push_back(plain::norm_weights<float>(w, "encoder.norm" + std::to_string(i)));
    full_gru_ = {plain::gru_weights<float>(w, "encoder.gru.0"), full, latent_.tiles(), kSide,
                 backend_};
    half_gru_ = {plain::gru_weights<float>(w, "encoder.gru.1"), half, half_tiles_, kHalfSide,
                 backend_};
    states_.emplace_back(height, width, channels_, in_.numbers(), true);
    states_.emplace_back(half.height, half.width, channels_, in_.numbers(), true);
    x0_ = inner_ = x2_ = y0_ = y1_ = {height, width, channels_};
    raw_ = {height, width, channels_};
    sums_.resize(latent_.tiles().size() * 2 * std::size_t(channels_));
    scale_.resize(std::size_t(channels_));
    shift_.resize(std::size_t(channels_));

    std::size_t convolving = 0;
    for (const PackedConv* made : {&in_, &res_[0], &res_[1], &head_[0], &head_[1], &head_[2]})
        convolving = std::max(convolving, made->scratch_size(kSide, kSide));
    const auto inputs = std::size_t(std::max(3 * channels_, model.config.input_channels()));
    const std::size_t joined = std::size_t(kSide + 2) * (kSide + 2) * inputs;
    constexpr int kWide = kHalfSide + 4;
    const std::size_t down =
        std::size_t(kWide) * kWide * std::size_t(channels_) + down_.scratch_size(kWide, kWide);
    runner_.make_room(
        std::max({joined + convolving, full_gru_.scratch_size(), half_gru_.scratch_size() + down}),
        std::max(latent_.tiles().size(), half_tiles_.size()));
}

std::string ThesisEncoder::description() const {
    return engine_name(backend_);
}

void ThesisEncoder::step(const VoxelGrid& grid, LatentCodes& latent) noexcept {
    latent_.begin_step();
    feed_in(grid.values);
    normalise(0, nullptr, x0_);
    step_full();
    convolve(res_[0], states_[0].exact());
    normalise(1, nullptr, inner_);
    convolve(res_[1], inner_);
    normalise(2, &states_[0].exact(), x2_);
    step_half();
    join_head();
    normalise(3, nullptr, y0_);
    convolve(head_[1], y0_);
    normalise(4, &y0_, y1_);
    runner_.over(latent_.tiles(), [&](std::size_t i, const Tile& tile, float* scratch) {
        Array3<float>& codes = latent.values;
        head_[2].run(
            {y1_.at(tile.y0 - 1, tile.x0 - 1), y1_.pitch(), codes.pixel(tile.y0, tile.x0).data(),
             std::ptrdiff_t(codes.width()) * codes.channels(), tile.height(), tile.width()},
            scratch);
        latent_.mark_changed(i);
    });
    latent.history = latent_.history();
}

ConvCall ThesisEncoder::into_raw(const Tile& tile, const float* in, std::ptrdiff_t pitch) noexcept {
    return {in,
            pitch,
            raw_.pixel(tile.y0, tile.x0).data(),
            std::ptrdiff_t(raw_.width()) * channels_,
            tile.height(),
            tile.width()};
}

void ThesisEncoder::feed_in(const Array3<float>& grid) noexcept {
    runner_.over(latent_.tiles(), [&](std::size_t i, const Tile& tile, float* scratch) {
        const Tile near = tile.grown(1, grid.height(), grid.width());
        const std::ptrdiff_t c = grid.channels(), row = (tile.width() + 2) * c;
        std::memset(scratch, 0, std::size_t((tile.height() + 2) * row) * sizeof(float));
        for (int y = near.y0; y < near.y1; ++y)
            backend_.f32->compress(grid.pixel(y, near.x0).data(),
                                   scratch + (y - tile.y0 + 1) * row + (near.x0 - tile.x0 + 1) * c,
                                   std::size_t(near.width()) * std::size_t(c), 0);
        in_.run(into_raw(tile, scratch, row), scratch + (tile.height() + 2) * row);
        keep_sums(i);
    });
}

void ThesisEncoder::convolve(const PackedConv& conv, const PaddedMap& from) noexcept {
    runner_.over(latent_.tiles(), [&](std::size_t i, const Tile& tile, float* scratch) {
        conv.run(into_raw(tile, from.at(tile.y0 - 1, tile.x0 - 1), from.pitch()), scratch);
        keep_sums(i);
    });
}

void ThesisEncoder::keep_sums(std::size_t i) noexcept {
    const auto channels = std::size_t(channels_);
    double* sum = sums_.data() + i * 2 * channels;
    double* squares = sum + channels;
    std::fill_n(sum, 2 * channels, 0.0);
    const Tile& tile = latent_.tiles()[i];
    for (int y = tile.y0; y < tile.y1; ++y) {
        const float* pixel = raw_.pixel(y, tile.x0).data();
        for (int x = tile.x0; x < tile.x1; ++x, pixel += channels)
            for (std::size_t c = 0; c < channels; ++c) {
                const double v = pixel[c];
                sum[c] += v;
                squares[c] += v * v;
            }
    }
}

/// mean_c and variance_c from the tiles' sums, then norm(x)_c = scale_c x + shift_c:
///
///     scale_c = gamma_c / sqrt(variance_c + 1e-5)
///     shift_c = beta_c - mean_c scale_c + gamma_c alpha_c (mean_c - M) / sqrt(V + 1e-5)
///
/// M, V: mean and unbiased variance of the means (`grand`, `spread`).
void ThesisEncoder::normalise(std::size_t norm, const PaddedMap* skip, PaddedMap& to) noexcept {
    constexpr double kEpsilon = 1e-5;
    const auto channels = std::size_t(channels_);
    const double pixels = double(raw_.height()) * raw_.width();
    const auto total = [&](std::size_t at) {
        double sum = 0;
        for (std::size_t i = 0; i < latent_.tiles().size(); ++i)
            sum += sums_[i * 2 * channels + at];
        return sum / pixels;
    };
    double grand = 0, spread = 0;
    for (std::size_t c = 0; c < channels; ++c) grand += total(c) / double(channels);
    for (std::size_t c = 0; c < channels; ++c) spread += std::pow(total(c) - grand, 2);
    if (channels > 1) spread /= double(channels - 1);
    const plain::NormWeights<float>& weights = norms_[norm];
    for (std::size_t c = 0; c < channels; ++c) {
        const double mean = total(c);
        // E[x^2] - E[x]^2, which rounding may leave below 0.
        const double variance = std::max(total(channels + c) - mean * mean, 0.0);
        const double scale = weights.gamma[c] / std::sqrt(variance + kEpsilon);
        scale_[c] = float(scale);
        shift_[c] = float(weights.beta[c] - mean * scale +
                          weights.gamma[c] * weights.alpha[c] * (mean - grand) /
                              std::sqrt(spread + kEpsilon));
    }
    runner_.over(latent_.tiles(), [&](std::size_t, const Tile& tile, float*) {
        for (int y = tile.y0; y < tile.y1; ++y)
            backend_.f32->norm_elu(raw_.pixel(y, tile.x0).data(), scale_.data(), shift_.data(),
                                   skip != nullptr ? skip->at(y, tile.x0) : nullptr,
                                   to.at(y, tile.x0), std::size_t(tile.width()), channels_);
    });
}

/// h0 <- gru.0(x0, h0)
void ThesisEncoder::step_full() noexcept {
    runner_.over(latent_.tiles(), [&](std::size_t i, const Tile&, float* scratch) {
        full_gru_.step(states_[0], i, nullptr, scratch, [&](const ConvGru::Target& target) {
            const Tile& region = target.region;
            for (int y = region.y0; y < region.y1; ++y)
                states_[0].numbers().from_float(x0_.at(y, region.x0), std::size_t(region.width()),
                                                channels_,
                                                target.out + (y - region.y0) * target.pitch);
        });
    });
    runner_.over(latent_.tiles(),
                 [&](std::size_t i, const Tile&, float*) { full_gru_.commit(states_[0], i); });
}

/// h1 <- gru.1(elu(down x2), h1)
void ThesisEncoder::step_half() noexcept {
    runner_.over(half_tiles_, [&](std::size_t i, const Tile&, float* scratch) {
        // down of a tile and 2 more on each side, in float32: at most 28 x 28 pixels.
        float* wide = scratch + half_gru_.scratch_size();
        half_gru_.step(states_[1], i, nullptr, scratch, [&](const ConvGru::Target& target) {
            const Tile& region = target.region;
            const std::ptrdiff_t row = std::ptrdiff_t(region.width()) * channels_;
            down_.run(ConvCall{x2_.at(2 * region.y0 - 1, 2 * region.x0 - 1), x2_.pitch(), wide, row,
                               region.height(), region.width()},
                      wide + region.height() * row);
            backend_.f32->elu(wide, wide, std::size_t(region.height() * row));
            for (int y = 0; y < region.height(); ++y)
                states_[1].numbers().from_float(wide + y * row, std::size_t(region.width()),
                                                channels_, target.out + y * target.pitch);
        });
    });
    runner_.over(half_tiles_,
                 [&](std::size_t i, const Tile&, float*) { half_gru_.commit(states_[1], i); });
}

/// raw_ = head.0 of [up2(h1); x2; x0]
void ThesisEncoder::join_head() noexcept {
    const PaddedMap& below = states_[1].read();
    const Numbers& numbers = states_[1].numbers();
    const std::ptrdiff_t units = numbers.units(channels_);
    runner_.over(latent_.tiles(), [&](std::size_t i, const Tile& tile, float* scratch) {
        const std::ptrdiff_t row = (tile.width() + 2) * units, area = (tile.height() + 2) * row;
        std::memset(scratch, 0, std::size_t(area) * sizeof(float));
        const Tile near = tile.grown(1, raw_.height(), raw_.width());
        for (int y = near.y0; y < near.y1; ++y)
            double_row(below, numbers, channels_, y, near.x0, near.x1,
                       scratch + (y - tile.y0 + 1) * row + (near.x0 - tile.x0 + 1) * units);
        ConvArea call;
        call.in[0] = {scratch, row};
        float* rest = scratch + area;
        // Scratch: up2(h1) of the tile and a rim of 1, then, where layers read bf16, x2 and x0 of
        // the same pixels; in float32 these are read where they lie.
        for (std::size_t n = 1; n < 3; ++n) {
            const PaddedMap& from = n == 1 ? x2_ : x0_;
            call.in[n] = {from.at(tile.y0 - 1, tile.x0 - 1), from.pitch()};
            if (numbers.bf16() == nullptr) continue;
            for (int y = 0; y < tile.height() + 2; ++y)
                numbers.from_float(from.at(tile.y0 - 1 + y, tile.x0 - 1),
                                   std::size_t(tile.width() + 2), channels_, rest + y * row);
            call.in[n] = {rest, row};
            rest += area;
        }
        const ConvCall raw = into_raw(tile, nullptr, 0);
        call.out = raw.out;
        call.out_pitch = raw.out_pitch;
        call.height = raw.height;
        call.width = raw.width;
        head_[0].run(call, rest);
        keep_sums(i);
    });
}

void ThesisEncoder::reset() noexcept {
    for (StateMap& state : states_) state.clear();
}

}  // namespace eventide
