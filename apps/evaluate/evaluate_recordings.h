// One recording with reference images, judged: shared by plain recordings and the EVREAL protocol.
#pragma once

#include "apps/evaluate/evaluation.h"
#include "apps/evaluate/reference_sequence.h"

namespace eventide {

/// Which images count.
struct ScoredImages {
    int skip = 0;   ///< so many at the beginning do not
    int given = 0;  ///< every so many images one is given to the model instead; 0: none
    SensorTime from = SensorTime::min(), to = SensorTime::max();
    bool is_given(std::size_t image) const { return given > 0 && image % std::size_t(given) == 0; }
};

SequenceResult evaluate_sequence(const Evaluation& evaluation, ReferenceSequence sequence,
                                 const std::string& window, const ScoredImages& which);

}  // namespace eventide
