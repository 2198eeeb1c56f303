// --budget: what the network may take of the processor.
#include "apps/cli/settings/budget.h"

#include "src/core/error.h"
#include "src/settings/values.h"

namespace eventide::app {

std::optional<double> Budget::cores(double frames_per_second) const {
    if (share) return share;
    if (!per_frame) return {};
    return std::chrono::duration<double>(*per_frame).count() * frames_per_second;
}

Budget parse_budget(const std::string& text) {
    if (text == "none") return {};
    try {
        if (text.ends_with('%'))
            return {{}, parse_number(text.substr(0, text.size() - 1), 0.1, 100'000) / 100};
        if (const SensorDuration time = parse_duration(text); time > SensorDuration{0})
            return {time, {}};
    } catch (const Error&) {  // said below, with all that is possible
    }
    throw_usage("none, a time for each frame such as 8ms, or a share of a core such as 50%", text);
}

std::string show_budget(const Budget& budget) {
    if (budget.share) return show_number(*budget.share * 100) + "%";
    return budget.per_frame ? show_duration(*budget.per_frame) : "none";
}

}  // namespace eventide::app
