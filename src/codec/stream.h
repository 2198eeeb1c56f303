// What a recording says about itself, and how data become bytes again.
#pragma once

#include "src/core/event.h"

#include <eventide/event.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace eventide {

/// What the beginning of a recording says. Fields a format does not have stay empty.
struct StreamHeader {
    std::string
        format;  ///< "text", "aedat1", "aedat2", "aedat3", "aedat4", "evt2", "evt21", "evt3", "dat"
    int width = 0, height = 0;  ///< px; 0 where the format does not say
    std::string sensor_name;    ///< "DAVIS346", "DVS128", ...
    std::string serial;
    ColourFilter colour_filter = ColourFilter::none;  ///< where the format says it
    std::string source_text;        ///< whatever else identifies the recording, for people
    std::uint64_t data_offset = 0;  ///< bytes before the first record
};

/// data -> bytes of one format: the inverse of a Parser. Throws Error (usage) for what the format
/// cannot hold, by name (a coordinate too large, a kind of data it has no record for).
class StreamWriter {
public:
    virtual ~StreamWriter() = default;
    virtual void begin(const StreamHeader& header, std::vector<std::byte>& out) = 0;
    /// Appends the bytes of a batch; the batches must follow each other in time.
    virtual void write(const Batch& batch, std::vector<std::byte>& out) = 0;
    /// Appends what ends the stream (an index, a last packet).
    virtual void finish(std::vector<std::byte>& out) = 0;
    /// Bytes to be written over the ones at `offset` once all is out (AEDAT4's table position);
    /// empty for most.
    struct Patch {
        std::uint64_t offset = 0;
        std::vector<std::byte> bytes;
    };
    virtual std::vector<Patch> patches() const { return {}; }
};

}  // namespace eventide
