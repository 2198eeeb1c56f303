// Times that no stream has.
#pragma once

#include "src/core/error.h"
#include "src/core/sensor_limits.h"

#include <eventide/reconstructor.h>

#include <string>

namespace eventide {

/// Beyond Reconstructor::kFarthestTime.
inline bool is_far(SensorTime t) {
    static_assert(Reconstructor::kFarthestTime == kFarthestUs);
    return to_us(t) > Reconstructor::kFarthestTime || to_us(t) < -Reconstructor::kFarthestTime;
}

/// Its own time or one of its exposure.
inline bool is_far(const ReferenceImage& image) {
    return is_far(image.t) || is_far(image.exposure_begin) || is_far(image.exposure_end);
}

/// Throws Error (usage) naming `what` for such a time: by it a stream would go on for ever.
inline void refuse_far(SensorTime t, const char* what) {
    if (is_far(t))
        throw Error(ErrorKind::usage, std::string{what} + ": expected a time of at most 2^60 us " +
                                          "from zero, found " + std::to_string(to_us(t)) + " us");
}

}  // namespace eventide
