// Flags of `eventide run` that would change nothing.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/settings/run_settings.h"

namespace eventide::app {

/// Throws Error (usage): refuse_idle_flag().
void refuse_idle_flags(const RunSettings& settings, const FlagKeys& flags);

}  // namespace eventide::app
