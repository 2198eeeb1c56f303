// What became of a picture: brightness, contrast and correlation against an earlier one.
#pragma once

#include "src/core/array.h"

#include <string>

namespace eventide::stress {

struct PictureChange {
    double mean = 0;         ///< mean intensity, now less then
    double contrast = 1;     ///< deviation of intensity, now over then
    double correlation = 1;  ///< Pearson's
};

PictureChange change_between(const Array2<float>& then, const Array2<float>& now);

/// A picture that has not faded. Brightness moved by less than the model's own error on scenes
/// whose truth is known (a mean squared error of .02 to .03, .15 RMS); contrast within a factor
/// of 1.5, which a person who looks at one after the other just sees; and the same shapes: at a
/// correlation of .8 noise would have to be of 3/4 of the picture's own deviation.
constexpr double kMeanMoves = .1, kContrast = 1.5, kCorrelation = .8;

bool is_kept(const PictureChange& change);
std::string words_of(const PictureChange& change);

}  // namespace eventide::stress
