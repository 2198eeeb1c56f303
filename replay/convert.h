// From one format to another, in bounded memory.
#pragma once

#include "replay/formats.h"
#include "replay/recording.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace eventide {

struct ConvertOptions {
    std::optional<SensorTime> from{}, to{};  ///< both included
    bool overwrite = false;
};

struct ConvertReport {
    DataCounts written;
    DataCounts not_held;  ///< left out because the target has no record for them
    Damage damaged;       ///< found in what was read
    std::uint64_t bytes_written = 0;
};

/// Writes the recording to `path` in the given format. `progress` is called after each chunk and
/// may return false: then what was written so far is completed. Throws Error (usage) for what the
/// format cannot hold (a coordinate too large), Error (failed) when the file cannot be written.
ConvertReport convert(Recording& recording, const std::string& path, const Format& format,
                      const ConvertOptions& options = {},
                      const std::function<bool()>& progress = {});

}  // namespace eventide
