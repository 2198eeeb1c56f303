// Outputs for which a run goes on.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "src/io/output_file.h"

#include <atomic>
#include <cstddef>
#include <string>

namespace eventide::app {

/// Those of --out but `null`, --record and --events-out; sigma apart from its video is one more.
std::size_t count_outputs(const RunSettings& settings);

/// A pipe is no output any more once nobody reads it. Thread: any.
class OutputsLeft {
public:
    explicit OutputsLeft(std::size_t outputs) : left_(std::ptrdiff_t(outputs)) {}

    /// Says that `name` is not read any more; once for each. Whether the run goes on for others.
    bool go_on_without(const std::string& name, PipeReader why);

private:
    std::atomic<std::ptrdiff_t> left_;
};

}  // namespace eventide::app
