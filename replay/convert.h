// From one format to another, in bounded memory.
#pragma once

#include "replay/formats.h"
#include "replay/recording.h"
#include "replay/written_data.h"
#include "src/io/output_file.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace eventide {

struct ConvertOptions {
    /// Both included; times of the clock that the recording begins with. What follows a clock reset
    /// counts as between them.
    std::optional<SensorTime> from{}, to{};
    bool overwrite = false;
    std::function<void(Batch&)> filter = {};    ///< of what lies between the limits; may be empty
    ColourFilter colours = ColourFilter::none;  ///< of the images behind it, where that is known
};

struct ConvertReport {
    std::uint64_t events_read = 0;  ///< before limits and filter
    DataCounts written;
    WrittenData data{FormatHolds{}};  ///< what the target could not hold as it was
    Damage damaged;                   ///< found in what was read
    std::uint64_t bytes_written = 0;
    std::uint64_t lost = 0;  ///< ConvertTarget::lost()
    PipeReader reader = PipeReader::takes;
};

/// Where converted data go.
class ConvertTarget {
public:
    virtual ~ConvertTarget() = default;
    virtual const FormatHolds& holds() const = 0;  ///< nothing else is written
    /// Throws Error: usage for what cannot be held (a coordinate too large), failed when it cannot
    /// be written.
    virtual void write(const Batch& batch) = 0;
    virtual void finish() = 0;  ///< once, after the last write
    /// As OutputFile::reader(): without one nothing more is wanted.
    virtual PipeReader reader() const { return PipeReader::takes; }
    virtual std::uint64_t bytes_written() const = 0;
    virtual std::uint64_t lost() const { return 0; }  ///< datagrams that nobody received
};

/// What a target is told of where its data come from.
StreamHeader header_of(const SensorInfo& sensor);

/// Writes the recording to the target. `progress` is called after each chunk and may return false:
/// then what was written so far is completed. Throws what the target throws.
ConvertReport convert(Recording& recording, ConvertTarget& target,
                      const ConvertOptions& options = {},
                      const std::function<bool()>& progress = {});

/// The same into a file of the given format.
ConvertReport convert(Recording& recording, const std::string& path, const Format& format,
                      const ConvertOptions& options = {},
                      const std::function<bool()>& progress = {});

}  // namespace eventide
