// What a run tells while it goes on: log.csv, validation.csv, learning_curve.svg, and lines for
// whoever watches.
#pragma once

#include "apps/train/network/losses.h"
#include "apps/train/validation.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace eventide {

using LogSink = std::function<void(const std::string&)>;  ///< takes a line

/// Where a run is when it tells something.
struct Mark {
    std::int64_t step = 0;
    double minutes = 0;
};

class TrainingLog {
public:
    /// Files are appended to, so that a resumed run goes on in them. Steps are told as means over
    /// `every` of them.
    TrainingLog(std::filesystem::path folder, int every, LogSink say);

    struct Step {
        double rate = 0, gradient = 0, seconds = 0;  ///< learning rate; norm; wall time
        std::int64_t skipped = 0;  ///< steps of the run so far whose gradient was not finite
    };
    /// Throws Error(failed) where a file cannot be written; validation() too.
    void step(const Mark& mark, const LossTerms& terms, const Step& step);
    void validation(const Mark& mark, const Validation::Scores& scores);

private:
    std::filesystem::path folder_;
    int every_;
    LogSink say_;
    std::array<double, kLossNames.size() + 2> sums_{};  // since the last line: means, norm, seconds
    int summed_ = 0;
};

}  // namespace eventide
