// The counters of a run as people and programs read them.
#include "apps/cli/run/report/run_report.h"

#include "apps/cli/printable.h"
#include "apps/cli/terminal.h"
#include "src/core/damage.h"
#include "src/core/number_text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace eventide::app {

namespace {

using Json = nlohmann::ordered_json;

double milliseconds(std::chrono::nanoseconds duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

Json json_of(const LatencySummary& summary) {
    return {{"p50", milliseconds(summary.p50)},
            {"p90", milliseconds(summary.p90)},
            {"p99", milliseconds(summary.p99)},
            {"max", milliseconds(summary.max)},
            {"mean", summary.count == 0 ? 0 : milliseconds(summary.total) / double(summary.count)}};
}

Json json_of(const Damage& damage) {
    Json counts = Json::object();
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        counts[std::string{name_of(DamageReason(i))}] = damage[DamageReason(i)];
    return counts;
}

Json json_of(const CameraCounters& camera) {
    Json counts = Json::object();
    for (std::size_t i = 0; i < kCameraCounts; ++i)
        counts[std::string{words_of(CameraCount(i)).name}] = camera[CameraCount(i)];
    return counts;
}

/// printf into a string; what is shown is short.
template <typename... Args>
std::string text_of(const char* format, Args... args) {
    char text[256];
    std::snprintf(text, sizeof text, format, args...);
    return text;
}

std::string latency_text(const Snapshot& now) {
    return text_of("latency %.1f/%.1f ms", milliseconds(now.latency.p50),
                   milliseconds(now.latency.p99));
}

std::string losses_text(const Snapshot& now) {
    return "lost " + std::to_string(now.lost()) + "  skipped " +
           std::to_string(now.skipped_frames) + "  damaged " + std::to_string(now.damaged.total());
}

}  // namespace

bool lost_data(const Snapshot& end) {
    return end.lost_packets > 0 || end.gaps > 0 || end.damaged.total() > 0 ||
           end.slicing.too_many > 0 || (end.camera && end.camera->lost_data());
}

std::string summary_text(const Snapshot& end, const RunProgress& progress) {
    const double seconds = progress.elapsed.count();
    // Those between --from (less its warm-up) and --to, behind the filters; what is parsed goes
    // beyond.
    const std::uint64_t events = end.window_events;
    std::string text = counted(end.frames, "frame") + " from " + short_count(double(events)) +
                       text_of(" %s in %.2f s", events == 1 ? "event" : "events", seconds);
    if (seconds > 0) text += text_of(" (%.1f frames/s)", double(end.frames) / seconds);
    if (progress.in_step && end.frames > 0) text += "; " + latency_text(end) + " (p50/p99)";
    text += "\n" + losses_text(end);
    if (end.filtered_events > 0) text += "  filtered " + short_count(double(end.filtered_events));
    if (end.merged_windows > 0) text += "  merged " + std::to_string(end.merged_windows);
    if (end.gaps > 0) text += "  gaps " + std::to_string(end.gaps);
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        if (const auto n = end.damaged[DamageReason(i)]; n > 0)
            text += "\n  " + std::string{name_of(DamageReason(i))} + ": " + std::to_string(n);
    if (end.camera)
        if (const std::string camera = camera_text(*end.camera, false); !camera.empty())
            text += "\n" + camera;
    return text;
}

std::string why_no_frames(const Snapshot& end) {
    if (end.frames > 0 || end.skipped_frames > 0) return {};
    const SlicerCounters& cut = end.slicing;
    if (end.events == 0 && end.damaged.total() > 0)
        return end.damaged[DamageReason::out_of_range] == end.damaged.total()
                   ? "no frame: every event lies outside the sensor (--input-size)"
                   : "no frame: no event could be read, as everything is damaged or laid out "
                     "otherwise (--input-format, --input-columns)";
    if (end.events == 0)
        return "no frame: no event was read; eventide info shows how many the recording holds, "
               "and their times";
    // The slicer counts behind the filters: where those that they took lie is not known.
    const std::uint64_t outside = cut.before_begin + cut.after_end;
    if (end.window_events == 0 && end.filtered_events > 0)
        return std::string{"no frame: filters left no event"} +
               (outside > 0 ? " between --from and --to" : "") +
               " (--noise-filter, --hot-pixels, --filter)";
    if (end.window_events == 0 && outside > 0)
        return cut.after_end == 0 ? "no frame: all events lie before --from"
                                  : "no frame: no event lies between --from and --to";
    return "no frame: what was asked for is shorter than the time between two frames (--fps)";
}

std::string camera_text(const CameraCounters& camera, bool brief) {
    std::string text;
    for (std::size_t i = 0; i < kCameraCounts; ++i) {
        const CameraCountWords& words = words_of(CameraCount(i));
        const std::uint64_t n = camera[CameraCount(i)];
        if (words.kind == CameraCountKind::traffic || n == 0) continue;
        std::string name{brief ? words.brief : words.name};
        std::ranges::replace(name, '_', ' ');
        if (brief)
            text += " " + name + " " + tight_count(n);
        else
            text += (text.empty() ? ": " : ", ") + name + " " + std::to_string(n);
    }
    return text.empty() ? "" : "camera" + text;
}

std::string stats_json(const Snapshot& now, const RunProgress& progress, bool final) {
    Json json;
    json["elapsed_s"] = progress.elapsed.count();
    json["final"] = final;
    const double seconds = progress.elapsed.count();
    const bool mean = final && seconds > 0;
    json["event_rate"] = mean ? double(now.events) / seconds : progress.event_rate;
    json["events"] = now.events;
    json["images"] = now.images;
    json["imu"] = now.imu;
    json["triggers"] = now.triggers;
    json["packets"] = now.packets;
    json["bytes"] = now.bytes;
    json["lost_packets"] = now.lost_packets;
    json["lost_bytes"] = now.lost_bytes;
    json["camera"] = now.camera ? json_of(*now.camera) : Json(nullptr);
    json["gaps"] = now.gaps;
    json["filtered_events"] = now.filtered_events;
    json["flicker_hz"] = now.flicker.hz > 0 ? Json(now.flicker.hz) : Json(nullptr);
    json["flicker_events"] = now.flicker.left_out;
    json["damaged"] = json_of(now.damaged);
    json["slicing"] = {{"before_begin", now.slicing.before_begin},
                       {"after_end", now.slicing.after_end},
                       {"too_many", now.slicing.too_many},
                       {"late", now.slicing.late},
                       {"late_references", now.slicing.late_references},
                       {"time_resets", now.slicing.time_resets}};
    json["event_windows"] = now.event_windows;
    json["silent_windows"] = now.silent_windows;
    json["merged_windows"] = now.merged_windows;
    json["window_begin_us"] = to_us(now.window.begin);
    json["window_end_us"] = to_us(now.window.end);
    json["encoded"] = now.encoded;
    json["state_resets"] = now.state_resets;
    json["frames"] = now.frames;
    json["skipped_frames"] = now.skipped_frames;
    json["broken_frames"] = now.broken_frames;
    json["used_images"] = now.used_images;
    json["dropped_images"] = now.dropped_images;
    json["newest_frame_us"] = now.frames > 0 ? Json(to_us(now.newest_frame)) : Json(nullptr);
    json["latency_ms"] = json_of(now.latency);
    json["work_ms"] = {{"bin", json_of(now.bin)},
                       {"encode", json_of(now.encode)},
                       {"take", json_of(now.take)},
                       {"render", json_of(now.render)},
                       {"write", json_of(now.write)}};
    if (progress.quality) json["quality"] = quality_json(*progress.quality, false);
    return json_text(json, -1);  // on one line
}

}  // namespace eventide::app
