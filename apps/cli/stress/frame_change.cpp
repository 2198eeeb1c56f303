// What became of a frame.
#include "apps/cli/stress/frame_change.h"

#include <cmath>
#include <cstdio>

namespace eventide::stress {

FrameChange change_between(const Array2<float>& then, const Array2<float>& now) {
    const auto n = double(then.values().size());
    double sum_a = 0, sum_b = 0, aa = 0, bb = 0, ab = 0;
    for (std::size_t i = 0; i < then.values().size(); ++i) {
        const double a = then.values()[i], b = now.values()[i];
        sum_a += a;
        sum_b += b;
        aa += a * a;
        bb += b * b;
        ab += a * b;
    }
    const double var_a = aa / n - sum_a / n * sum_a / n, var_b = bb / n - sum_b / n * sum_b / n;
    FrameChange change;
    change.mean = (sum_b - sum_a) / n;
    change.contrast = std::sqrt(var_b / var_a);
    change.correlation = (ab / n - sum_a / n * sum_b / n) / std::sqrt(var_a * var_b);
    return change;
}

bool is_kept(const FrameChange& change) {
    return std::abs(change.mean) <= kMeanMoves && change.contrast <= kContrast &&
           change.contrast >= 1 / kContrast && change.correlation >= kCorrelation;
}

std::string words_of(const FrameChange& change) {
    char text[96];
    std::snprintf(text, sizeof text, "brightness %+.3f, contrast x %.2f, correlation %.3f",
                  change.mean, change.contrast, change.correlation);
    return text;
}

}  // namespace eventide::stress
