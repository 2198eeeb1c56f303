// What writes files that are no streams of bytes: its library places the bytes itself.
#pragma once

#include "src/core/event.h"

namespace eventide {

class FileWriter {
public:
    virtual ~FileWriter() = default;
    /// The batches must follow each other in time. Throws Error: usage for what the format cannot
    /// hold, failed when it cannot be written.
    virtual void write(const Batch& batch) = 0;
    /// Once, after the last write: only then the file is whole. Throws as write().
    virtual void finish() = 0;
};

}  // namespace eventide
