// Outputs for which a run goes on.
#include "apps/cli/run/open_outputs.h"

#include "apps/cli/printable.h"

#include <spdlog/spdlog.h>

namespace eventide::app {

bool OpenOutputs::reader_left(const std::string& name) {
    const bool goes_on = --left_ > 0;
    spdlog::log(goes_on ? spdlog::level::warn : spdlog::level::info, "{}: its reader went away{}",
                printable(name), goes_on ? "; the run goes on for the other outputs" : "");
    return goes_on;
}

}  // namespace eventide::app
