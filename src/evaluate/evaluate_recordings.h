// One recording with reference images, judged: shared by plain recordings and the EVREAL protocol.
#pragma once

#include "src/evaluate/evaluation.h"
#include "src/evaluate/reference_sequence.h"

namespace eventide {

/// Which images count.
struct ScoredImages {
    int skip = 0;  ///< so many at the beginning do not
    SensorTime from = SensorTime::min(), to = SensorTime::max();
};

SequenceResult evaluate_sequence(const Evaluation& evaluation, const ReferenceSequence& sequence,
                                 const std::string& window, const ScoredImages& which);

}  // namespace eventide
