// SOURCE on the command line becomes a source of bytes.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "replay/real_time_playback.h"
#include "replay/recording.h"

#include <functional>
#include <memory>

namespace eventide::app {

/// What the command line named, in the one of three shapes that it has.
struct OpenedSource {
    std::unique_ptr<Source> source;
    Recording* recording = nullptr;     ///< the same object, where it is a recording
    RealTimePlayback* paced = nullptr;  ///< the same, where it keeps a pace
};

/// `speed`: 0 is as fast as possible. `give_up` is asked while something is waited for: true ends
/// that with an Error. Throws Error.
OpenedSource open_source(const RunSettings& settings, double speed,
                         const std::function<bool()>& give_up = {});

}  // namespace eventide::app
