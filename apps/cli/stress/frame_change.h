// What became of a frame: brightness, contrast and correlation against an earlier one.
#pragma once

#include "src/core/array.h"

#include <string>

namespace eventide::stress {

struct FrameChange {
    double mean = 0;         ///< mean intensity, now less then
    double contrast = 1;     ///< deviation of intensity, now over then
    double correlation = 1;  ///< Pearson's
};

FrameChange change_between(const Array2<float>& then, const Array2<float>& now);

/// A frame that has not faded: the mean stays within .02 of the range, contrast within a quarter,
/// and the same shapes are seen.
constexpr double kMeanMoves = .02, kContrast = 1.25, kCorrelation = .95;

bool is_kept(const FrameChange& change);
std::string words_of(const FrameChange& change);

}  // namespace eventide::stress
