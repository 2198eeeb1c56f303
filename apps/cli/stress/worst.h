// The largest of many errors.
#pragma once

#include <cmath>

namespace eventide::stress {

/// The larger; NaN where either is, which no later number may hide.
inline double worst_of(double a, double b) {
    return a >= b || std::isnan(a) ? a : b;
}

}  // namespace eventide::stress
