// SINK on the command line becomes a sink of frames.
#include "src/app/open_sinks.h"

#include "pipeline/sinks/contact_sheet.h"
#include "pipeline/sinks/folder.h"
#include "pipeline/sinks/null.h"
#include "pipeline/sinks/stream.h"
#include "pipeline/sinks/v4l2_output.h"
#include "pipeline/sinks/video.h"
#include "pipeline/sinks/window.h"
#include "src/core/error.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>

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

std::unique_ptr<Sink> open_folder(const std::string& path, const RunSettings& settings,
                                  const SinkPlan& plan) {
    return std::make_unique<FolderSink>(
        FolderSettings{path, settings.overwrite, settings.uncertainty, float(settings.sigma_white),
                       plan.questions.lost, plan.questions.run_json});
}

std::unique_ptr<Sink> open_video(const std::string& path, const RunSettings& settings,
                                 const SinkPlan& plan) {
    if (path.ends_with(".mkv"))
        spdlog::warn("{}: Matroska rounds times to 1 ms; MP4 keeps microseconds", path);
    return std::make_unique<VideoSink>(
        VideoSettings{path, settings.overwrite, settings.uncertainty, float(settings.sigma_white),
                      settings.video_preset, settings.video_crf, plan.fps});
}

std::unique_ptr<Sink> open_stream(const std::string& path, StreamFormat format,
                                  const RunSettings& settings, const SinkPlan& plan) {
    return std::make_unique<StreamSink>(
        StreamSettings{path, format, settings.overwrite, settings.uncertainty,
                       float(settings.sigma_white), plan.fps, plan.questions.stopping});
}

std::unique_ptr<Sink> open_window(const RunSettings& settings, const SinkPlan& plan) {
    WindowSettings window;
    window.title = "eventide: " + settings.source;
    window.uncertainty = settings.uncertainty;
    window.sigma_white = float(settings.sigma_white);
    window.speed = plan.speed;
    window.speed_changed = plan.questions.speed_changed;
    window.give_up = plan.questions.stopping;
    return std::make_unique<WindowSink>(std::move(window));
}

std::unique_ptr<Sink> open_v4l2(const std::string& node, const RunSettings& settings) {
    V4l2OutputSettings loopback;
    loopback.node = node;
    loopback.uncertainty = settings.uncertainty;
    loopback.sigma_white = float(settings.sigma_white);
    return std::make_unique<V4l2OutputSink>(std::move(loopback));
}

std::unique_ptr<Sink> open_sheet(const std::string& path, const RunSettings& settings,
                                 const SinkPlan& plan) {
    ContactSheetSettings sheet;
    sheet.path = path;
    sheet.overwrite = settings.overwrite;
    sheet.sigma_white = float(settings.sigma_white);
    sheet.rows = settings.sheet_rows;
    if (plan.references != nullptr)
        sheet.draw_truth = [references = plan.references, sensor = plan.sensor](const Frame& frame,
                                                                                cv::Mat& picture) {
            references->draw(frame, sensor.width, sensor.height, picture);
        };
    return std::make_unique<ContactSheetSink>(std::move(sheet));
}

std::unique_ptr<Sink> open_sink(const std::string& sink, const RunSettings& settings,
                                const SinkPlan& plan) {
    if (sink == "null") return std::make_unique<NullSink>();
    if (sink == "window") return open_window(settings, plan);
    if (sink == "-") return open_stream(sink, StreamFormat::y4m, settings, plan);
    if (const auto path = after_prefix(sink, "sheet")) return open_sheet(*path, settings, plan);
    if (const auto node = after_prefix(sink, "v4l2")) return open_v4l2(*node, settings);
    if (const auto path = after_prefix(sink, "folder")) return open_folder(*path, settings, plan);
    for (const StreamFormat format : kStreamFormats)
        if (const auto path = after_prefix(sink, name_of(format)))
            return open_stream(*path, format, settings, plan);
    if (sink.ends_with(".mp4") || sink.ends_with(".mkv")) return open_video(sink, settings, plan);
    if (sink.ends_with(".y4m")) return open_stream(sink, StreamFormat::y4m, settings, plan);
    if (sink.ends_with('/') || std::filesystem::is_directory(sink))
        return open_folder(sink, settings, plan);
    if (std::filesystem::is_fifo(sink)) return open_stream(sink, StreamFormat::y4m, settings, plan);
    throw Error(ErrorKind::usage,
                "--out " + sink +
                    ": expected a folder (ending in /), x.mp4, x.mkv, x.y4m, -, a named pipe, "
                    "window, null, v4l2:/dev/videoN, sheet:x.png, or y4m:, y4m-mono:, gray8:, "
                    "gray16:, grayf32: and "
                    "a file, pipe or -");
}

/// Two sinks on standard output would mix their bytes.
void refuse_two_on_standard_output(const std::vector<std::string>& sinks) {
    const auto takes_it = [](const std::string& sink) {
        return sink == "-" || sink.ends_with(":-");
    };
    if (std::ranges::count_if(sinks, takes_it) > 1)
        throw Error(ErrorKind::usage, "--out: only one sink can have standard output");
}

}  // namespace

bool is_window(const std::string& sink) {
    return sink == "window";
}

bool is_contact_sheet(const std::string& sink) {
    return sink.starts_with("sheet:");
}

std::vector<std::unique_ptr<Sink>> open_sinks(const RunSettings& settings, const SinkPlan& plan) {
    refuse_two_on_standard_output(settings.out);
    std::vector<std::unique_ptr<Sink>> plain, looked;
    LookSettings look = settings.look;
    look.unsharp = float(settings.unsharp);
    for (const std::string& sink : settings.out) {
        auto& where = look.changes_nothing() || is_contact_sheet(sink) ? plain : looked;
        where.push_back(open_sink(sink, settings, plan));
    }
    if (!looked.empty()) plain.push_back(std::make_unique<LookSink>(look, std::move(looked)));
    return plain;
}

}  // namespace eventide::app
