// Every file that eventide run was told to read or to write.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "src/io/named_files.h"

namespace eventide::app {

/// Before anything is opened. Throws Error: usage where an output is also an input or another
/// output, or may not be replaced.
void name_run_files(const RunSettings& settings, NamedFiles& files);

}  // namespace eventide::app
