// The fast renderer's spans: members added up pixel by pixel.
#include "src/kernels/vector_kernels.h"
#include "src/model/render/fast_renderer.h"

#include <algorithm>
#include <cmath>

namespace eventide {

void FastRenderer::render_spans(const Job& job, const Target& target) noexcept {
    for (const Span& span : spans_)
        pixels_rendered_ += std::uint64_t(layout().columns.begin[std::size_t(span.last)] -
                                          layout().columns.begin[std::size_t(span.first)]);
    for_each_tile(options_.parallel_for, int(spans_.size()), [&](int worker, int i) {
        render_span(job, spans_[std::size_t(i)], target, std::size_t(worker));
    });
}

FastRenderer::Rows FastRenderer::rows(std::size_t worker, RowsOf which) noexcept {
    const auto width = std::size_t(sizes_[size_].geometry.part_width);
    float* first = row_sums_[worker].data() + 3 * std::size_t(which) * width;
    return {first, first + width, needs_squares_ ? first + 2 * width : nullptr};
}

void FastRenderer::clear(const Rows& rows, const Span& span) const noexcept {
    const int begin = layout().columns.begin[std::size_t(span.first)],
              end = layout().columns.begin[std::size_t(span.last)];
    for (float* row : {rows.mu, rows.log_sigma, rows.square})
        if (row != nullptr) std::fill(row + begin, row + end, 0.0F);
}

/// Up to 8 members, added up in this order whichever span a pixel is in:
///
///     for time a, row b        base = dt_a slope_t + dy_b slope_y, weight w_a w_b
///       for side 0, 1          left samples, then right ones: + dx slope_x, weight times w_x
///
///     mu = sum w mu_i,  ln sigma = sum w s_i  or  sigma^2 = sum w (sigma_i^2 + mu_i^2) - mu^2
///
/// Where the live edge fades, w_a is taken out of the first sum over b and sides: what a window
/// shows at its end, which is the same for all frames of the next.
void FastRenderer::render_span(const Job& job, const Span& span, const Target& target,
                               std::size_t worker) noexcept {
    const AxisSamples& t = job.time(span.is_still);
    const Rows blended = rows(worker, RowsOf::frame);
    std::size_t sample = 0;
    if (t.index < 0) {
        sample = t.weight[0] != 0 ? 0 : 1;
        begin_with_end(job, span, sample++, worker);
    } else {
        clear(blended, span);
    }
    for (; sample < 2; ++sample)
        if (t.weight[sample] != 0) add_sample(job, span, sample, t.weight[sample], blended, worker);
    put(job, span, blended, target);
}

void FastRenderer::begin_with_end(const Job& job, const Span& span, std::size_t sample,
                                  std::size_t worker) noexcept {
    const Rows blended = rows(worker, RowsOf::frame);
    Rows end = rows(worker, RowsOf::end);
    if (job.keeps_end) {
        WindowEnd& kept = sizes_[size_].end;
        end = {kept.mu(span.row), kept.log_sigma(span.row), nullptr};
    }
    if (!span.has_end) {
        clear(end, span);
        add_sample(job, span, sample, 1, end, worker);
    }
    const auto weight = float(job.time(span.is_still).weight[sample]);
    const int first = layout().columns.begin[std::size_t(span.first)],
              last = layout().columns.begin[std::size_t(span.last)];
    const auto weigh = [&](const float* from, float* to) {
        for (int i = first; i < last; ++i) to[i] = weight * from[i];
    };
    weigh(end.mu, blended.mu);
    weigh(end.log_sigma, blended.log_sigma);
    if (end.square != nullptr) weigh(end.square, blended.square);
}

void FastRenderer::add_sample(const Job& job, const Span& span, std::size_t sample, double weight,
                              const Rows& to, std::size_t worker) noexcept {
    const AxisSamples y =
        sample_axis(job.geometry.y + span.row, job.geometry.height, job.geometry.sensor_height,
                    config_.latent_stride, config_.blend);
    const double dt = job.time(span.is_still).offset[sample];
    const Rows outputs = rows(worker, RowsOf::member);
    float* base = scratch_[worker].data();
    for (std::size_t b = 0; b < 2; ++b) {
        if (y.weight[b] == 0) continue;
        for (std::size_t o = 0; o < std::size_t(first_); ++o)
            base[o] = slope_[0][o] * float(dt) + slope_[2][o] * float(y.offset[b]);
        const int row = y.index + int(b);
        const Array3<float>& sums = job.sums[sample]->values;
        // The row of samples below is the next that rows of pixels further down read.
        const std::ptrdiff_t ahead =
            row + 1 < sums.height() ? std::ptrdiff_t(sums.width()) * sums.channels() : 0;
        for (std::size_t side = 0; side < 2; ++side)
            evaluate({sums.pixel(row, 0).data(), ahead, base, float(weight * y.weight[b]), side},
                     span, to, outputs, base + first_);
    }
}

/// The row's intensity and sigma, from what its members gave together.
void FastRenderer::put(const Job& job, const Span& span, const Rows& blended,
                       const Target& target) const noexcept {
    const auto begin = std::size_t(layout().columns.begin[std::size_t(span.first)]),
               end = std::size_t(layout().columns.begin[std::size_t(span.last)]);
    const std::size_t row = std::size_t(span.row) * std::size_t(job.geometry.part_width);
    std::copy(blended.mu + begin, blended.mu + end, target.intensity + row + begin);
    if (target.sigma == nullptr) return;
    float* sigma = target.sigma + row;
    if (blended.square == nullptr) {  // ln sigma is blended
        numbers_.kernels().scaled_exp(blended.log_sigma + begin, config_.sigma_scale, sigma + begin,
                                      end - begin);
        return;
    }
    // Rounding may leave a variance below 0.
    for (std::size_t i = begin; i < end; ++i) {
        const float mu = blended.mu[i], square = blended.square[i];
        sigma[i] = config_.sigma_scale * std::sqrt(std::max(square - mu * mu, 0.0F));
    }
}

}  // namespace eventide
