// A look into a recording before anything is written: does it hold what was asked for?
#pragma once

#include "apps/cli/run/run_plan.h"

namespace eventide::app {

/// Throws Error (usage) where a recording has no event from --from on or until --to, or where
/// --window aps finds no image in it. Live sources and what can be read but once are not looked at.
void check_recording(const RunSettings& settings, const Span& span, const SlicerSettings& slicer);

}  // namespace eventide::app
