// What became of a frame.
#include "apps/cli/stress/frame_change.h"

#include "src/metrics/image_measures.h"

#include <cmath>
#include <cstdio>

namespace eventide::stress {

FrameChange change_between(const Array2<float>& then, const Array2<float>& now) {
    const Spread both = spread(then, now);
    FrameChange change;
    change.mean = both.mean_b - both.mean_a;
    change.contrast = std::sqrt(both.var_b / both.var_a);
    change.correlation = correlation(both).value_or(NAN);
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
