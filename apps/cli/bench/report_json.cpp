// The report as JSON.
#include "apps/bench/stage_table.h"
#include "apps/cli/bench/report.h"
#include "apps/cli/printable.h"

#include <nlohmann/json.hpp>

namespace eventide::app {

namespace {

nlohmann::ordered_json json_of(const SpeedRow& row) {
    nlohmann::ordered_json json{{"model", row.model},
                                {"engine", row.engine},
                                {"width", row.sensor.width},
                                {"height", row.sensor.height},
                                {"window", row.window},
                                {"encode_ms", row.encode_ms},
                                {"render_fresh_ms", row.render_ms},
                                {"mse", row.error.raw.mse},
                                {"front", row.is_on_front}};
    if (row.error.raw.lpips) json["lpips"] = *row.error.raw.lpips;
    if (row.error.raw.ssim > 0) json["ssim"] = row.error.raw.ssim;
    if (row.against_double > 0) json["codes_rms_of_range"] = row.against_double;
    return json;
}

}  // namespace

std::string json_of(const Report& report) {
    nlohmann::ordered_json json;
    json["machine"] = report.machine;
    json["program"] = report.program;
    json["settings"] = report.settings;
    for (const char* list : {"speed", "peers", "rates", "loads", "memory"})
        json[list] = nlohmann::ordered_json::array();
    for (const SpeedRow& row : report.speed) json["speed"].push_back(json_of(row));
    for (const RateRow& row : report.rates)
        json["rates"].push_back({{"model", row.model},
                                 {"fps", row.fps},
                                 {"render_ms", row.render_ms},
                                 {"times_real_time", row.times_real_time}});
    for (const PeerRow& row : report.peers)
        json["peers"].push_back({{"network", row.network},
                                 {"engine", row.engine},
                                 {"instructions", row.instructions},
                                 {"width", row.sensor.width},
                                 {"height", row.sensor.height},
                                 {"threads", row.threads},
                                 {"wall_ms", row.wall_ms}});
    json["activity"] = bench::activity_json(report.activity);
    for (const LoadRow& row : report.loads)
        json["loads"].push_back({{"events_per_s", row.events_per_s},
                                 {"latency_p50_ms", row.p50_ms},
                                 {"latency_p99_ms", row.p99_ms},
                                 {"time_taken", row.behind}});
    for (const MemoryRow& row : report.memory)
        json["memory"].push_back({{"model", row.model},
                                  {"width", row.sensor.width},
                                  {"height", row.sensor.height},
                                  {"resident_mib", row.resident_mib}});
    return json_text(json) + "\n";
}

}  // namespace eventide::app
