// IMU samples of AEDAT 2.0: seven words of one time, one measure each.
#pragma once

#include "src/core/damage.h"
#include "src/core/event.h"

#include <cstdint>

namespace eventide {

/// Collects words until the last of a sample; samples that miss words are left out and counted. The
/// temperature may be missing (recorders can leave it out: six words).
class Aedat2ImuAssembler {
public:
    /// `measure`: 0-2 acceleration, 3 temperature, 4-6 gyro.
    void word(unsigned measure, std::int16_t value, SensorTime t, Batch& into, Damage& damage);
    void finish(Damage& damage);
    void drop() { seen_ = 0; }

private:
    ImuSample sample_;
    unsigned seen_ = 0;  ///< one bit per measure
};

}  // namespace eventide
