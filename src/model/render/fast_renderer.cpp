// See fast_renderer.h; docs/model.md has the formulas.
#include "src/model/render/fast_renderer.h"

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
    for (Size& size : sizes_) {
        size.kept.reset();
        size.end.reset();
    }
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
    size.layout.make(
        geometry, config_.latent_stride, config_.blend,
        latent_row_edges(latent_samples(geometry.sensor_height, config_.latent_stride)),
        latent_column_edges(latent_samples(geometry.sensor_width, config_.latent_stride)));
    size.kept.make_room(geometry, size.layout.tiles());
    size.end.make_room(geometry, size.layout.tiles());
    spans_.reserve(std::size_t(geometry.part_height) * std::size_t(size.layout.columns.count()));
    // Nine rows of part_width numbers: three for each of RowsOf.
    for (FloatBuffer& sums : row_sums_)
        sums.resize(std::max(sums.size(), 9 * std::size_t(geometry.part_width)));
    size.geometry = geometry;
}

std::array<const FirstLayerCache::WindowSums*, 2> FastRenderer::bring_sums(
    const CodeChoice& codes, const AxisSamples& t) noexcept {
    const std::int64_t k = codes.k + t.index;
    // Where a live edge fades neither is known, and what it shows of the event window before was
    // made without z_k.
    const bool whole = codes.next[0], next_whole = codes.next[1];
    if (t.weight[1] == 0) return {&first_layer_.at(k, whole), nullptr};
    if (t.weight[0] == 0) return {nullptr, &first_layer_.at(k + 1, next_whole)};
    return first_layer_.pair(k, whole, next_whole);
}

FastRenderer::Job FastRenderer::job_of(const CodeChoice& codes, const FrameGeometry& geometry,
                                       SigmaRule rule) noexcept {
    const bool fades = config_.live_edge == LiveEdge::fade && codes.k > 1;
    const AxisSamples t = sample_time(codes.fraction, codes.next[0], fades);
    // The thesis' network knows no stillness: its codes change for ever.
    const AxisSamples still_t =
        config_.encoder == EncoderKind::gated ? sample_still_time(t, codes.next[0], fades) : t;
    const bool keeps_end = t.index < 0 && !needs_squares_ && sizes_[size_].end.is_kept();
    return {geometry, rule, t, still_t, keeps_end, bring_sums(codes, t)};
}

void FastRenderer::render(const CodeChoice& codes, const FrameGeometry& geometry, SigmaRule rule,
                          Array2<float>& intensity, Array2<float>* sigma) noexcept {
    lay_out(geometry);
    needs_squares_ = sigma != nullptr && rule == SigmaRule::mixture;
    const Job job = job_of(codes, geometry, rule);
    KeptFrame& kept = sizes_[size_].kept.choose(kind_of(codes, job, sigma != nullptr),
                                                codes.fraction, options_.still_time);
    find_outdated(codes, job, kept);
    render_spans(job, {kept.intensity.data(), sigma != nullptr ? kept.sigma.data() : nullptr});
    std::ranges::copy(kept.intensity, intensity.values().data());
    if (sigma != nullptr) std::ranges::copy(kept.sigma, sigma->values().data());
}

FrameKind FastRenderer::kind_of(const CodeChoice& codes, const Job& job,
                                bool has_sigma) const noexcept {
    return {.geometry = job.geometry,
            .rule = job.rule,
            .has_sigma = has_sigma,
            .read = codes_read(job.t.index, codes.next[0], codes.next[1])};
}

/// Whether every code that the pixels of a tile read is the same in all of z_from .. z_to.
bool FastRenderer::is_still(int row, int column, std::int64_t from,
                            std::int64_t to) const noexcept {
    return layout().all_read(row, column,
                             [&](std::size_t tile) { return first_layer_.still(tile, from, to); });
}

bool FastRenderer::is_up_to_date(const KeptFrame& kept, int row, int column,
                                 const CodeChoice& codes, double fraction) const noexcept {
    if (!options_.skip_quiet) return false;
    const KeptFrame::Stamp& stamp =
        kept.tiles[std::size_t(row) * std::size_t(layout().columns.count()) + std::size_t(column)];
    if (stamp.k < 1 || stamp.k > codes.k) return false;
    // The same time again: of the event window the same codes are known, or its kind would differ.
    if (stamp.k == codes.k && stamp.fraction == fraction) return true;
    if (std::abs(stamp.fraction - fraction) > options_.still_time) return false;
    return is_still(row, column, stamp.k + kept.kind.read.oldest, codes.k + kept.kind.read.newest);
}

bool FastRenderer::note_end(std::size_t tile, std::int64_t k) noexcept {
    WindowEnd& end = sizes_[size_].end;
    const bool is_there = end.holds(tile, k);
    end.note(tile, k);
    return is_there;
}

/// Of a row of tiles with rows 10 to 41 and five tiles, of which o are out of date:
///
///     tiles     0    1    2    3    4
///               o    o         o         spans {10, 0, 2}, {10, 3, 4}, then {11, 0, 2}, ...
void FastRenderer::find_outdated(const CodeChoice& codes, const Job& job,
                                 KeptFrame& kept) noexcept {
    spans_.clear();
    const int columns = layout().columns.count();
    for (int r = 0; r < layout().rows.count(); ++r) {
        const auto begin = spans_.size();
        const int first_row = layout().rows.begin[std::size_t(r)],
                  last_row = layout().rows.begin[std::size_t(r) + 1];
        for (int c = 0; c < columns; ++c) {
            KeptFrame::Stamp& stamp = kept.tiles[std::size_t(r * columns + c)];
            const bool shows_end =
                job.still_t != job.t &&
                is_still(r, c, codes.k + kept.kind.read.oldest, codes.k + kept.kind.read.newest);
            const double fraction = shows_end ? 1 : codes.fraction;
            const bool is_kept = is_up_to_date(kept, r, c, codes, fraction);
            stamp.k = codes.k;
            if (is_kept) continue;
            stamp.fraction = fraction;
            if (first_row == last_row) continue;  // beside the part of the frame that is asked for
            const bool begins_before = job.time(shows_end).weight[0] != 0;
            const bool has_end = job.keeps_end && note_end(std::size_t(r * columns + c),
                                                           codes.k - (begins_before ? 1 : 0));
            if (spans_.size() > begin && spans_.back().last == c &&
                spans_.back().is_still == shows_end && spans_.back().has_end == has_end)
                spans_.back().last = c + 1;
            else
                spans_.push_back({first_row, c, c + 1, shows_end, has_end});
        }
        // Rows below the first are cut as it is.
        const auto end = spans_.size();
        for (int row = first_row + 1; row < last_row; ++row)
            for (auto i = begin; i < end; ++i)
                spans_.push_back(
                    {row, spans_[i].first, spans_[i].last, spans_[i].is_still, spans_[i].has_end});
    }
}

}  // namespace eventide
