// Outputs for which a run goes on.
#pragma once

#include <atomic>
#include <cstddef>
#include <string>

namespace eventide::app {

/// A pipe is no output any more once its reader has gone away. Thread: any.
class OpenOutputs {
public:
    void expect(std::size_t outputs) { left_ = std::ptrdiff_t(outputs); }

    /// Says that the reader of `name` went away; once for each. Whether the run goes on for others.
    bool reader_left(const std::string& name);

private:
    std::atomic<std::ptrdiff_t> left_{0};
};

}  // namespace eventide::app
