// See fast_renderer.h; docs/model.md has the formulas.
#include "src/model/render/fast_renderer.h"

#include "src/kernels/vector_kernels.h"
#include "src/nn/load_weights.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace eventide {
namespace {

/// [in][out] of a linear layer.
std::vector<float> transposed(const Tensor& weight) {
    const auto outputs = std::size_t(weight.shape[0]), inputs = std::size_t(weight.shape[1]);
    std::vector<float> values(weight.values.size());
    for (std::size_t o = 0; o < outputs; ++o)
        for (std::size_t i = 0; i < inputs; ++i)
            values[i * outputs + o] = weight.values[o * inputs + i];
    return values;
}

}  // namespace

FastRenderer::FastRenderer(const Model& model, int sensor_width, int sensor_height,
                           const EngineOptions& options, const Backend& backend)
    : config_(model.config),
      options_(options),
      backend_(backend),
      numbers_(backend),
      first_(config_.mlp[0]),
      widest_(*std::ranges::max_element(config_.mlp)),
      first_layer_(model, latent_samples(sensor_height, config_.latent_stride),
                   latent_samples(sensor_width, config_.latent_stride), options, backend) {
    const Tensor& first = model.weights.at("renderer.mlp.0.weight");
    const auto inputs = std::size_t(first.shape[1]);
    // The last three inputs of layer 1, [H_1][27 D + 3]: t - t_v, x - x_v, y - y_v.
    for (std::size_t o = 0; o < std::size_t(first_); ++o)
        for (std::size_t d = 0; d < 3; ++d)
            slope_[d].push_back(first.values[(o + 1) * inputs - 3 + d]);
    for (std::size_t i = 1; i <= config_.mlp.size(); ++i) {
        const std::string name = "renderer.mlp." + std::to_string(i);
        const Tensor& weight = model.weights.at(name + ".weight");
        const std::vector<float>& bias = model.weights.at(name + ".bias").values;
        if (i < config_.mlp.size()) {
            layers_.emplace_back(1, 1, int(weight.shape[1]), int(weight.shape[0]),
                                 transposed(weight), bias, true, backend);
        } else {
            last_weight_ = weight.values;
            last_bias_ = bias;
        }
    }
    // `base` of render_span(), then three maps of a block (run_blocks()).
    scratch_.assign(kWorkers, FloatBuffer(std::size_t(first_) +
                                          std::size_t(kBlock) * 3 * std::size_t(widest_)));
    // Sized by lay_out(), as it depends on the frame.
    row_sums_.resize(kWorkers);
}

std::string FastRenderer::description() const {
    return engine_name(backend_);
}

void FastRenderer::reset() noexcept {
    first_layer_.reset();
    for (Size& size : sizes_) size.kept.reset();
}

void FastRenderer::push(std::int64_t k, const LatentCodes& latent) noexcept {
    first_layer_.push(k, latent);
}

void FastRenderer::take(std::int64_t k, LatentCodes& latent) noexcept {
    first_layer_.take(k, latent);
}

void FastRenderer::lay_out(const FrameGeometry& geometry) {
    if (geometry == sizes_[size_].geometry) return;
    size_ = 1 - size_;
    Size& size = sizes_[size_];
    if (geometry == size.geometry) return;
    size.geometry = {};  // until all is there
    size.layout.make(geometry, config_.latent_stride, config_.blend, first_layer_.row_edges(),
                     first_layer_.column_edges());
    size.kept.make_room(geometry, size.layout.tiles());
    spans_.reserve(std::size_t(geometry.part_height) *
                   std::size_t(size.layout.columns.count() / 2 + 1));
    // Six rows of part_width numbers: mu, ln sigma and square, twice.
    // What members have given together, and what one gives.
    for (FloatBuffer& sums : row_sums_)
        sums.resize(std::max(sums.size(), 6 * std::size_t(geometry.part_width)));
    size.geometry = geometry;
}

AxisSamples FastRenderer::time_samples(const CodeChoice& codes) const noexcept {
    const bool fades = config_.live_edge == LiveEdge::fade && codes.k > 1;
    return sample_time(codes.fraction, codes.next[0], fades);
}

std::array<const FirstLayerCache::Sums*, 2> FastRenderer::bring_sums(
    const CodeChoice& codes, const AxisSamples& t) noexcept {
    const std::int64_t k = codes.k + t.index;
    // What a fading live edge shows of the event window before was made without z_k.
    const bool whole = t.index == 0 && codes.next[0], next_whole = t.index == 0 && codes.next[1];
    if (t.weight[1] == 0) return {&first_layer_.at(k, whole), nullptr};
    if (t.weight[0] == 0) return {nullptr, &first_layer_.at(k + 1, next_whole)};
    return first_layer_.pair(k, whole, next_whole);
}

void FastRenderer::render(const CodeChoice& codes, const FrameGeometry& geometry, SigmaRule rule,
                          Array2<float>& intensity, Array2<float>* sigma) noexcept {
    lay_out(geometry);
    needs_squares_ = sigma != nullptr && rule == SigmaRule::mixture;
    const AxisSamples t = time_samples(codes);
    const Job job{geometry, rule, t, bring_sums(codes, t)};
    const Target out{intensity.values().data(),
                     sigma != nullptr ? sigma->values().data() : nullptr};
    if (!options_.skip_quiet) {
        spans_.clear();
        for (int row = 0; row < geometry.part_height; ++row)
            spans_.push_back({row, 0, layout().columns.count()});
        render_spans(job, out);
        return;
    }
    KeptFrame& kept = sizes_[size_].kept.choose(kind_of(codes, job, sigma != nullptr),
                                                codes.fraction, options_.still_time);
    find_outdated(codes, kept);
    render_spans(job, {kept.intensity.data(), sigma != nullptr ? kept.sigma.data() : nullptr});
    std::ranges::copy(kept.intensity, out.intensity);
    if (sigma != nullptr) std::ranges::copy(kept.sigma, out.sigma);
}

/// Codes read: sample k + index reads z_{k+index-1} up to `newest`.
///
///     t.index 0, next 2 known     z_{k-1} .. z_{k+2}
///     t.index 0, next known       z_{k-1} .. z_{k+1}
///     t.index 0                   z_{k-1}, z_k
///     t.index -1, a fading edge   z_{k-2} .. z_k
FrameKind FastRenderer::kind_of(const CodeChoice& codes, const Job& job,
                                bool has_sigma) const noexcept {
    const int index = job.t.index;
    int newest = index;  // of the sample at `index`, then of the one after it
    if (index == 0 && codes.next[0]) newest = codes.next[1] ? 2 : 1;
    if (index < 0) newest = 0;
    return {.geometry = job.geometry,
            .rule = job.rule,
            .has_sigma = has_sigma,
            .oldest = index - 1,
            .newest = newest,
            .time_index = index};
}

bool FastRenderer::is_up_to_date(const KeptFrame& kept, int row, int column,
                                 const CodeChoice& codes) const noexcept {
    const auto r = std::size_t(row), c = std::size_t(column);
    const auto columns = std::size_t(layout().columns.count());
    const KeptFrame::Stamp& stamp = kept.tiles[r * columns + c];
    if (stamp.k < 1 || stamp.k > codes.k) return false;
    // The same time again: of the event window the same codes are known, or its kind would differ.
    if (stamp.k == codes.k && stamp.fraction == codes.fraction) return true;
    if (std::abs(stamp.fraction - codes.fraction) > options_.still_time) return false;
    for (std::size_t y = r; y <= r + layout().rows.reads_next[r]; ++y)
        for (std::size_t x = c; x <= c + layout().columns.reads_next[c]; ++x)
            if (!first_layer_.still(y * columns + x, stamp.k + kept.kind.oldest,
                                    codes.k + kept.kind.newest))
                return false;
    return true;
}

/// Of a row of tiles with rows 10 to 41 and five tiles, of which o are out of date:
///
///     tiles     0    1    2    3    4
///               o    o         o         spans {10, 0, 2}, {10, 3, 4}, then {11, 0, 2}, ...
void FastRenderer::find_outdated(const CodeChoice& codes, KeptFrame& kept) noexcept {
    spans_.clear();
    const int columns = layout().columns.count();
    for (int r = 0; r < layout().rows.count(); ++r) {
        const auto begin = spans_.size();
        const int first_row = layout().rows.begin[std::size_t(r)],
                  last_row = layout().rows.begin[std::size_t(r) + 1];
        for (int c = 0; c < columns; ++c) {
            KeptFrame::Stamp& stamp = kept.tiles[std::size_t(r * columns + c)];
            const bool is_kept = is_up_to_date(kept, r, c, codes);
            stamp.k = codes.k;
            if (is_kept) continue;
            stamp.fraction = codes.fraction;
            if (first_row == last_row) continue;  // beside the part of the frame that is asked for
            if (spans_.size() > begin && spans_.back().last == c)
                spans_.back().last = c + 1;
            else
                spans_.push_back({first_row, c, c + 1});
        }
        // Rows below the first are cut as it is.
        const auto end = spans_.size();
        for (int row = first_row + 1; row < last_row; ++row)
            for (auto i = begin; i < end; ++i)
                spans_.push_back({row, spans_[i].first, spans_[i].last});
    }
}

void FastRenderer::render_spans(const Job& job, const Target& target) noexcept {
    for (const Span& span : spans_)
        pixels_rendered_ += std::uint64_t(layout().columns.begin[std::size_t(span.last)] -
                                          layout().columns.begin[std::size_t(span.first)]);
    for_each_tile(options_.parallel_for, int(spans_.size()), [&](int worker, int i) {
        render_span(job, spans_[std::size_t(i)], target, std::size_t(worker));
    });
}

/// Up to 8 members, added up in this order whichever span a pixel is in:
///
///     for time a, row b        base = dt_a slope_t + dy_b slope_y, weight w_a w_b
///       for side 0, 1          left samples, then right ones: + dx slope_x, weight times w_x
///
///     mu = sum w mu_i,  ln sigma = sum w s_i  or  sigma^2 = sum w (sigma_i^2 + mu_i^2) - mu^2
void FastRenderer::render_span(const Job& job, const Span& span, const Target& target,
                               std::size_t worker) noexcept {
    const int width = job.geometry.part_width;
    const auto count = std::size_t(width);
    const auto begin = std::size_t(layout().columns.begin[std::size_t(span.first)]),
               end = std::size_t(layout().columns.begin[std::size_t(span.last)]);
    const AxisSamples y =
        sample_axis(job.geometry.y + span.row, job.geometry.height, job.geometry.sensor_height,
                    config_.latent_stride, config_.blend);
    float* scratch = scratch_[worker].data();
    float* blended = row_sums_[worker].data();  // mu, ln sigma, sigma^2 + mu^2
    for (std::size_t n = 0; n < 3; ++n) std::fill_n(blended + n * count + begin, end - begin, 0.0F);
    float* base = scratch;
    for (std::size_t n = 0; n < 4; ++n) {
        const std::size_t a = n / 2, b = n % 2;
        const double weight = job.t.weight[a] * y.weight[b];
        if (weight == 0) continue;
        for (std::size_t o = 0; o < std::size_t(first_); ++o)
            base[o] = slope_[0][o] * float(job.t.offset[a]) + slope_[2][o] * float(y.offset[b]);
        const int sample = y.index + int(b);
        const Array3<float>& sums = job.sums[a]->values;
        // The row of samples below is the next that rows of pixels further down read.
        const std::ptrdiff_t ahead =
            sample + 1 < sums.height() ? std::ptrdiff_t(sums.width()) * sums.channels() : 0;
        for (std::size_t side = 0; side < 2; ++side)
            evaluate({sums.pixel(sample, 0).data(), ahead, base, float(weight), side}, span,
                     blended, width, scratch + first_);
    }
    const std::size_t row = std::size_t(span.row) * count;
    std::copy(blended + begin, blended + end, target.intensity + row + begin);
    if (target.sigma == nullptr) return;
    float* sigma = target.sigma + row;
    if (job.rule == SigmaRule::log_blend) {
        numbers_.kernels().scaled_exp(blended + count + begin, config_.sigma_scale, sigma + begin,
                                      end - begin);
        return;
    }
    // Rounding may leave a variance below 0.
    for (std::size_t i = begin; i < end; ++i) {
        const float mu = blended[i], square = blended[2 * count + i];
        sigma[i] = config_.sigma_scale * std::sqrt(std::max(square - mu * mu, 0.0F));
    }
}

}  // namespace eventide
