// Flags of `eventide run` that would change nothing.
#include "apps/cli/run/idle_flags.h"

#include "apps/cli/idle_flag.h"
#include "apps/cli/settings/sink_name.h"
#include "drivers/devices.h"
#include "drivers/simulated/simulated_name.h"
#include "pipeline/sinks/video/video_kind.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace eventide::app {

namespace {

bool is_stream(const SinkName& sink) {
    return sink.kind == SinkKind::stream;
}
bool is_sheet(const SinkName& sink) {
    return sink.kind == SinkKind::sheet;
}
bool is_page(const SinkName& sink) {
    return sink.kind == SinkKind::http;
}
bool is_h264(const SinkName& sink) {
    return sink.kind == SinkKind::video &&
           video_kind_of(sink.path).encoder == std::string_view{"libx264"};
}

struct SinkFlag {
    const char* key;
    bool (*takes)(const SinkName&);
    const char* expected;
};
constexpr SinkFlag kSinkFlags[]{
    {"overload", is_stream, "a raw stream or Y4M"}, {"video_crf", is_h264, "x.mp4 or x.mkv"},
    {"video_preset", is_h264, "x.mp4 or x.mkv"},    {"sheet_rows", is_sheet, "contact-sheet:x.png"},
    {"http_token", is_page, "http:ADDRESS:PORT"},   {"http_name", is_page, "http:ADDRESS:PORT"}};

/// Without --out, states alone are made, with the flags of the runs that go on from there.
void refuse_without_sink(const RunSettings& settings, const FlagKeys& flags) {
    if (settings.out.empty()) return;
    for (const SinkFlag& flag : kSinkFlags)
        if (std::ranges::none_of(settings.out,
                                 [&](const auto& out) { return flag.takes(parse_sink(out)); }))
            refuse_idle_flag(flags, flag.key, std::string{flag.expected} + " as --out");
}

/// Cameras and simulations say all this themselves.
void refuse_without_recording(const RunSettings& settings, const FlagKeys& flags) {
    if (!names_camera(settings.source) && !names_simulation(settings.source)) return;
    for (const char* key :
         {"input_columns", "input_time_unit", "reorder", "input_dvs128_one_is_on"})
        refuse_idle_flag(flags, key, "a recording as SOURCE", settings.source);
}

}  // namespace

void refuse_idle_flags(const RunSettings& settings, const FlagKeys& flags) {
    refuse_without_sink(settings, flags);
    refuse_without_recording(settings, flags);
    if (settings.warmup && !settings.from)
        refuse_idle_flag(flags, "warmup", "--from, before which it lies");
    refuse_idle_precision(flags, settings.engine, settings.precision);
    if (settings.engine == Engine::plain && settings.kernels == Kernels::onednn)
        refuse_idle_flag(flags, "kernels", "own with --engine plain", "onednn");
}

}  // namespace eventide::app
