// SINK as it is written on the command line, taken apart.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "pipeline/sinks/raw_stream.h"
#include "src/io/named_files.h"

#include <string>

namespace eventide::app {

enum class SinkKind { nothing, window, folder, video, stream, sheet, v4l2, http, ros2 };

struct SinkName {
    SinkKind kind = SinkKind::nothing;
    std::string path;                         ///< of what has one; the address of http
    StreamFormat format = StreamFormat::y4m;  ///< of streams
};

/// Throws Error (usage) for what names no sink.
SinkName parse_sink(const std::string& text);

/// Names the files that the sinks of --out will write. Throws Error (usage).
void name_sink_files(const RunSettings& settings, NamedFiles& files);

}  // namespace eventide::app
