// See stage_table.h.
#include "apps/bench/stage_table.h"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace eventide::bench {
namespace {

template <typename... Arguments>
std::string text(const char* format, Arguments... arguments) {
    char line[256];
    std::snprintf(line, sizeof line, format, arguments...);
    return line;
}

std::string with_quartiles(const Spread& spread) {
    return text("%.2f (%.2f-%.2f)", spread.median, spread.low, spread.high);
}

void add_stage(nlohmann::ordered_json& json, const std::string& key, const Stage& stage,
               double peak) {
    const auto spread = [](const Spread& s) {
        return nlohmann::ordered_json{{"median", s.median}, {"low", s.low}, {"high", s.high}};
    };
    json[key + "_ms"] = stage.time.cpu_ms.median;
    json[key + "_cpu_ms"] = spread(stage.time.cpu_ms);
    json[key + "_wall_ms"] = spread(stage.time.wall_ms);
    json[key + "_products"] = stage.products;
    json["share"][key] = stage.share(peak);
}

}  // namespace

std::string peaks_text(const Peaks& peaks) {
    std::string line = "one core's peak, GFLOP/s: f32";
    const auto add = [&](double rate, const char* name) {
        if (rate > 0) line += text(" %.0f (%s)", rate, name);
    };
    add(peaks.f32_sse4, "SSE4");
    add(peaks.f32_avx2, "AVX2");
    add(peaks.f32_avx512, "AVX-512");
    if (peaks.bf16 > 0) line += text(", bf16 %.0f", peaks.bf16);
    if (peaks.bf16_amx > 0) line += text(" %.0f (AMX)", peaks.bf16_amx);
    if (peaks.int8 > 0) line += text(", int8 %.0f", peaks.int8);
    return line + text("; copy %.1f GB/s\n", peaks.copy_gb_s);
}

std::string stages_text(const std::vector<StageRow>& rows) {
    std::string table = text("%-10s %-26s %-9s %3s %21s %21s %21s %8s %18s\n", "model", "engine",
                             "sensor", "thr", "encode, cpu ms", "fresh frame, cpu ms",
                             "frame again, cpu ms", "bin Mev/s", "share of peak, %");
    for (const StageRow& row : rows)
        table +=
            text("%-10s %-26s %-9s %3d %21s %21s %21s %8.0f %6.0f/%.0f/%.0f\n", row.model.c_str(),
                 row.engine.c_str(), text("%dx%d", row.width, row.height).c_str(), row.threads,
                 with_quartiles(row.encode.time.cpu_ms).c_str(),
                 with_quartiles(row.fresh.time.cpu_ms).c_str(),
                 with_quartiles(row.again.time.cpu_ms).c_str(), row.bin_mev_s.median,
                 100 * row.encode.share(row.peak_gflops), 100 * row.fresh.share(row.peak_gflops),
                 100 * row.again.share(row.peak_gflops));
    return table;
}

nlohmann::ordered_json stages_json(const std::vector<StageRow>& rows, const Peaks& peaks) {
    auto json = nlohmann::ordered_json::array();
    for (const StageRow& row : rows) {
        nlohmann::ordered_json one{{"model", row.model},
                                   {"engine", row.engine},
                                   {"width", row.width},
                                   {"height", row.height},
                                   {"threads", row.threads}};
        add_stage(one, "encode", row.encode, row.peak_gflops);
        add_stage(one, "render_fresh", row.fresh, row.peak_gflops);
        add_stage(one, "render_again", row.again, row.peak_gflops);
        one["bin_mev_s"] = row.bin_mev_s.median;
        one["peak_f32_gflops"] = peaks.f32();
        one["peak_bf16_gflops"] = peaks.bf16;
        one["peak_bf16_amx_gflops"] = peaks.bf16_amx;
        one["peak_int8_gops"] = peaks.int8;
        one["copy_gb_s"] = peaks.copy_gb_s;
        json.push_back(std::move(one));
    }
    return json;
}

std::string activity_text(const std::vector<ActivityRow>& rows) {
    std::string table =
        text("%-10s %-26s %-9s %7s %7s %16s %7s %16s %10s %16s %10s %10s\n", "model", "engine",
             "sensor", "moving", "changed", "encode ms (%)", "exact", "frame ms (%)", "max error",
             "anywhere ms (%)", "max error", "RMS");
    for (const ActivityRow& row : rows) {
        ActivityRow dense = row;
        for (const ActivityRow& other : rows)
            if (other.model == row.model && other.engine == row.engine &&
                other.width == row.width && other.height == row.height && other.moving >= 1)
                dense = other;
        const auto with_share = [](const Spread& ms, const Spread& all) {
            return text("%.3f (%.1f)", ms.median, 100 * ms.median / all.median);
        };
        table += text(
            "%-10s %-26s %-9s %6.1f%% %6.1f%% %16s %7s %16s %10.2g %16s %10.2g %10.2g\n",
            row.model.c_str(), row.engine.c_str(), text("%dx%d", row.width, row.height).c_str(),
            100 * row.moving, 100 * row.changed, with_share(row.encode_ms, dense.encode_ms).c_str(),
            row.is_encode_exact ? "yes" : "NO", with_share(row.render_ms, dense.render_ms).c_str(),
            row.error.most, with_share(row.anywhere_ms, dense.anywhere_ms).c_str(),
            row.anywhere.most, row.anywhere.rms);
    }
    return table;
}

nlohmann::ordered_json activity_json(const std::vector<ActivityRow>& rows) {
    auto json = nlohmann::ordered_json::array();
    for (const ActivityRow& row : rows)
        json.push_back({{"model", row.model},
                        {"engine", row.engine},
                        {"width", row.width},
                        {"height", row.height},
                        {"moving", row.moving},
                        {"changed", row.changed},
                        {"encode_ms", row.encode_ms.median},
                        {"encode_exact", row.is_encode_exact},
                        {"render_ms", row.render_ms.median},
                        {"render_max_error", row.error.most},
                        {"anywhere_ms", row.anywhere_ms.median},
                        {"anywhere_max_error", row.anywhere.most},
                        {"anywhere_rms_error", row.anywhere.rms}});
    return json;
}

}  // namespace eventide::bench
