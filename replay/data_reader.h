// What reads files that are no streams of bytes: arrays (HDF5, NumPy), bags of messages.
#pragma once

#include "src/codec/stream.h"
#include "src/core/damage.h"
#include "src/core/event.h"

#include <string>
#include <vector>

namespace eventide {

/// Data of one file from front to back, in parts of bounded size. Source thread.
class DataReader {
public:
    virtual ~DataReader() = default;

    /// Its data_offset means nothing here.
    virtual const StreamHeader& header() const = 0;

    /// Appends the next part, each kind of data in the order of the file; damage is counted and
    /// left out. False at the end. Throws Error (input) where reading cannot go on.
    virtual bool read(Batch& into, Damage& damage) = 0;

    /// Goes to a place from which all data at or after `t` come, also backwards. May count damage
    /// (an index that does not fit) at the next read().
    virtual void seek(SensorTime t) = 0;

    /// How much of the whole file was read, 0 to 1.
    virtual double progress() const = 0;

    /// As Recording::remarks().
    virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace eventide
