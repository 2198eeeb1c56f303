// The moving line of a run.
#include "apps/cli/run/report/status_line.h"

#include "apps/cli/run/fitted_line.h"
#include "apps/cli/terminal.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace eventide::app {

namespace {

enum Part : std::size_t {
    share,
    speed,
    left,
    rate,
    window,
    frames,
    quality,
    latency,
    losses,
    camera
};
// What people watch a run for goes last.
constexpr std::size_t kGivesWay[]{camera, quality, window,  share, frames,  quality,
                                  rate,   losses,  share,   speed, latency, losses,
                                  camera, left,    latency, left,  speed};

template <typename... Args>
std::string text_of(const char* format, Args... args) {
    char text[64];
    std::snprintf(text, sizeof text, format, args...);
    return text;
}

double milliseconds(std::chrono::nanoseconds duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

LinePart losses_part(const Snapshot& now) {
    const std::uint64_t lost = now.lost(), skipped = now.skipped_frames,
                        damaged = now.damaged.total();
    const auto those_there_are = [&](const char* skip, const char* damage) {
        std::string text;
        const auto add = [&](const char* name, std::uint64_t n) {
            if (n > 0) text += (text.empty() ? "" : " ") + std::string{name} + " " + tight_count(n);
        };
        add("lost", lost);
        add(skip, skipped);
        add(damage, damaged);
        return text.empty() ? "lost 0" : text;
    };
    return {"lost " + std::to_string(lost) + "  skipped " + std::to_string(skipped) + "  damaged " +
                std::to_string(damaged),
            those_there_are("skipped", "damaged"), those_there_are("skip", "dam")};
}

LinePart speed_part(const Snapshot& now, const RunProgress& progress) {
    const auto passed = std::chrono::duration<double>(now.window.end - now.begin);
    if (progress.in_step || now.event_windows == 0 || progress.elapsed.count() <= 0 ||
        passed.count() <= 0)
        return {};
    const double speed = passed / progress.elapsed;
    const std::string times = text_of(speed < 0.1  ? "%.2fx"
                                      : speed < 10 ? "%.1fx"
                                                   : "%.0fx",
                                      speed);
    return {times + " real time", times, ""};
}

LinePart latency_part(const Snapshot& now, const RunProgress& progress) {
    if (!progress.in_step || now.frames == 0) return {};
    const double p50 = milliseconds(now.latency.p50), p99 = milliseconds(now.latency.p99);
    return {text_of("latency %.1f/%.1f ms", p50, p99), text_of("%.0f/%.0f ms", p50, p99), ""};
}

LinePart quality_part(const RunProgress& progress) {
    if (!progress.quality || !progress.quality->chosen) return {};
    const QualityState& state = *progress.quality;
    const std::string level = level_text(state.level, state.frames_per_second);
    return {state.model + " " + state.precision + " " + level, level, ""};
}

}  // namespace

double share_done(const Snapshot& now, const RunProgress& progress) {
    double share = 0;
    if (progress.total_bytes > 0) share = double(now.parsed_bytes) / double(progress.total_bytes);
    // A part of a recording ends before its bytes do; one that ends early ends with its bytes.
    if (now.event_windows > 0 && (progress.end || progress.duration)) {
        const SensorDuration length = progress.end ? *progress.end - now.begin : *progress.duration;
        const SensorDuration passed = now.window.end - now.begin;
        if (length.count() > 0)
            share = std::max(share, double(passed.count()) / double(length.count()));
    }
    return std::clamp(share, 0.0, 1.0);
}

std::string status_line(const Snapshot& now, const RunProgress& progress, std::size_t columns) {
    const bool ends = progress.total_bytes > 0 || progress.end || progress.duration;
    const double done = share_done(now, progress);
    std::vector<LinePart> parts(camera + 1);
    if (ends) parts[share] = share_part(done);
    if (ends) parts[left] = left_part(progress.elapsed, done);
    parts[speed] = speed_part(now, progress);
    parts[rate] = {short_count(progress.event_rate) + " events/s", ""};
    parts[window] = {text_of("window %.1f ms", double(now.window.width().count()) / 1000), ""};
    parts[frames] = {"frames " + std::to_string(now.frames), ""};
    parts[quality] = quality_part(progress);
    parts[latency] = latency_part(now, progress);
    parts[losses] = losses_part(now);
    if (now.camera)
        parts[camera] = {camera_text(*now.camera, false), camera_text(*now.camera, true), ""};
    return fitted_line(parts, kGivesWay, columns);
}

}  // namespace eventide::app
