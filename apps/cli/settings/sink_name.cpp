// SINK as it is written on the command line, taken apart.
#include "apps/cli/settings/sink_name.h"

#include "apps/cli/commands/command_files.h"
#include "apps/cli/terminal.h"
#include "pipeline/ros2/ros2_name.h"
#include "pipeline/sinks/folder.h"
#include "pipeline/sinks/http/http_address.h"
#include "pipeline/sinks/video/video.h"
#include "pipeline/sinks/video/video_kind.h"
#include "src/core/error.h"
#include "src/core/lower_case.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace eventide::app {

namespace {

constexpr StreamFormat kStreamFormats[]{StreamFormat::y4m, StreamFormat::y4m_mono,
                                        StreamFormat::gray8, StreamFormat::gray16,
                                        StreamFormat::grayf32};

/// What is after "name:", or nothing.
std::optional<std::string> after_prefix(const std::string& sink, std::string_view name) {
    if (!sink.starts_with(std::string{name} + ":")) return std::nullopt;
    return sink.substr(name.size() + 1);
}

std::optional<SinkName> with_prefix(const std::string& sink) {
    if (const auto path = after_prefix(sink, "contact-sheet"))
        return SinkName{SinkKind::sheet, *path};
    if (const auto address = after_prefix(sink, "http")) {
        parse_http_address(*address);
        return SinkName{SinkKind::http, *address};
    }
    if (const auto node = after_prefix(sink, "v4l2")) return SinkName{SinkKind::v4l2, *node};
    if (const auto name = after_prefix(sink, "ros2")) return SinkName{SinkKind::ros2, *name};
    if (const auto path = after_prefix(sink, "folder")) return SinkName{SinkKind::folder, *path};
    for (const StreamFormat format : kStreamFormats)
        if (const auto path = after_prefix(sink, name_of(format)))
            return SinkName{SinkKind::stream, *path, format};
    return std::nullopt;
}

bool takes_stamps(const SinkName& sink) {
    return sink.kind == SinkKind::stream && !is_y4m(sink.format);
}

/// Null shows nothing, whatever is asked for.
bool shows_events(const SinkName& sink) {
    return sink.kind != SinkKind::stream && sink.kind != SinkKind::v4l2 &&
           sink.kind != SinkKind::ros2;
}

/// A setting that changes nothing is a misunderstanding.
void check_effects(const RunSettings& settings) {
    const auto any = [&](bool (*does)(const SinkName&)) {
        return std::ranges::any_of(settings.out,
                                   [&](const auto& text) { return does(parse_sink(text)); });
    };
    if (settings.stamp && !any(takes_stamps))
        throw Error(ErrorKind::usage,
                    "--stamp: expected a raw stream such as --out gray8:-, found none; Y4M has the "
                    "times in its frame headers (XT=) without it");
    if (settings.events && !settings.out.empty() && !any(shows_events))
        throw Error(ErrorKind::usage,
                    "--events: expected the window, a video or a folder to show them in, found "
                    "none; --events-out writes the events themselves");
}

void name_sink(const std::string& text, const SinkName& sink, const RunSettings& settings,
               NamedFiles& files) {
    switch (sink.kind) {
        case SinkKind::folder:
            return name_run_folder("--out", sink.path, FolderSink::files(), files);
        case SinkKind::video:
            files.writes("--out", sink.path, text);
            if (settings.uncertainty == Uncertainty::separate)
                files.writes("--out", sigma_path(sink.path));
            return;
        case SinkKind::stream:
            refuse_terminal("--out " + text, sink.path, settings.force);
            return files.writes("--out", sink.path, text);
        case SinkKind::sheet:
            return files.writes_when_done("--out", sink.path, text);
        case SinkKind::ros2:
            return files.reads("--out", parse_ros2_sink_name(sink.path).calibration);
        case SinkKind::nothing:
        case SinkKind::window:
        case SinkKind::v4l2:
        case SinkKind::http:
            return;
    }
}

}  // namespace

SinkName parse_sink(const std::string& sink) {
    if (sink == "null") return {};
    if (sink == "window") return {SinkKind::window, {}};
    if (sink == "-") return {SinkKind::stream, sink};
    if (const auto name = with_prefix(sink)) {
        if (name->path.empty() && name->kind != SinkKind::http)
            throw Error(ErrorKind::usage, "--out " + sink + " needs a path, such as --out " + sink +
                                              (name->kind == SinkKind::v4l2    ? "/dev/video9"
                                               : name->kind == SinkKind::ros2  ? "/camera"
                                               : name->kind == SinkKind::sheet ? "x.png"
                                                                               : "x"));
        return *name;
    }
    if (names_video(sink)) return {SinkKind::video, sink};
    if (lower_case(sink).ends_with(".y4m")) return {SinkKind::stream, sink};
    std::error_code none;  // a name that no file can have is none of these
    if (sink.ends_with('/') || std::filesystem::is_directory(sink, none))
        return {SinkKind::folder, sink};
    if (std::filesystem::is_fifo(sink, none)) return {SinkKind::stream, sink};
    throw Error(ErrorKind::usage,
                "--out " + sink +
                    ": expected a folder (ending in /), x.mp4, x.mkv, x.avi, x.gif, x.y4m, -, a "
                    "named pipe, "
                    "window, null, http:ADDRESS:PORT, ros2:/NAME, v4l2:/dev/videoN, "
                    "contact-sheet:x.png, or y4m:, y4m-mono:, gray8:, "
                    "gray16:, grayf32: and a file, pipe or -");
}

void name_sink_files(const RunSettings& settings, NamedFiles& files) {
    check_effects(settings);
    for (const bool folders : {true, false})  // as they are opened: others may lie in one
        for (const std::string& text : settings.out)
            if (const SinkName sink = parse_sink(text); folders == (sink.kind == SinkKind::folder))
                name_sink(text, sink, settings, files);
}

}  // namespace eventide::app
