// What a soak watched, drawn over its time.
#include "apps/cli/stress/soak_plots.h"

#include <string>

namespace eventide::app {

namespace {

Plot plot_of(const std::string& name, const std::string& title, const std::string& unit) {
    return {.name = name, .title = title, .x_label = "hours of stream time", .y_label = unit};
}

}  // namespace

std::vector<Plot> soak_plots(const std::vector<stress::SoakSample>& samples) {
    Plot memory = plot_of("soak_memory", "Resident memory", "MiB");
    Plot latency = plot_of("soak_latency", "Latency at full speed", "ms");
    Plot state = plot_of("soak_state", "Recurrent states", "absolute value");
    memory.series = {{"resident", {}, {}, {}}};
    latency.series = {{"p50", {}, {}, {}}, {"p99", {}, {}, {}}};
    state.series = {{"largest", {}, {}, {}}, {"root mean square", {}, {}, {}}};
    const auto put = [](Series& series, double x, double y) {
        series.x.push_back(x);
        series.y.push_back(y);
    };
    for (const stress::SoakSample& sample : samples) {
        const double x = sample.stream_hours;
        put(memory.series[0], x, sample.resident_mib);
        put(latency.series[0], x, sample.latency_p50_ms);
        put(latency.series[1], x, sample.latency_p99_ms);
        put(state.series[0], x, sample.largest_state);
        put(state.series[1], x, sample.rms_state);
    }
    return {memory, latency, state};
}

}  // namespace eventide::app
