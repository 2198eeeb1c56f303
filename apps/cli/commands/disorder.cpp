// Shares of what was read.
#include "apps/cli/commands/disorder.h"

#include <cstdio>

namespace eventide::app {

std::string disorder_text(const std::string& name, const std::string& format, std::uint64_t events,
                          const Damage& damaged) {
    const std::uint64_t late = damaged[DamageReason::time_backwards];
    if (late == 0) return {};
    char share[32];
    std::snprintf(share, sizeof share, "%.2g %%", 100 * double(late) / double(events + late));
    return name + ": " + std::to_string(late) + " events (" + share +
           ") left out, their times lie before those of events already read" +
           (format == "text" ? "; a larger --reorder puts them in order, sorting the file does, too"
                             : "");
}

}  // namespace eventide::app
