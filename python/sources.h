// Recordings and cameras for Python: each with what it told beside its events.
#pragma once

#include "python/parts.h"

#include <eventide/camera.h>
#include <eventide/event.h>
#include <eventide/reader.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace eventide::python {

/// What a source has told so far.
struct Told {
    std::optional<SensorTime> clock;
    std::uint64_t damaged = 0;
};

/// A reader or camera.
template <typename T>
struct Source : Guarded<T> {
    using Guarded<T>::Guarded;

    /// By mutex.
    Told told() const { return running ? *running : now(); }
    Told now() const { return {this->it.clock(), this->it.damaged()}; }

    // By mutex.
    Batch batch;                         // read last
    std::vector<ReferenceImage> images;  // a reader's, beside the newest events or after the last
    bool gap_before = false;             // the newest events
    bool handed_out = true;              // the events that these two belong to
    /// Set while a Pipeline reads it, which then needs no mutex: what it had told after the newest
    /// read.
    std::optional<Told> running;
};

}  // namespace eventide::python
