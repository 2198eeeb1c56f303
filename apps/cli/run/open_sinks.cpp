// SINK on the command line becomes a sink of frames.
#include "apps/cli/run/open_sinks.h"

#include "apps/cli/run/sink_geometry.h"
#include "apps/cli/settings/sink_name.h"
#include "pipeline/ros2/ros2_sink.h"
#include "pipeline/sinks/contact_sheet.h"
#include "pipeline/sinks/folder.h"
#include "pipeline/sinks/http/http_sink.h"
#include "pipeline/sinks/http/request_guard.h"
#include "pipeline/sinks/null.h"
#include "pipeline/sinks/raw_stream.h"
#include "pipeline/sinks/v4l2_output.h"
#include "pipeline/sinks/video/video.h"
#include "pipeline/sinks/video/video_kind.h"
#include "pipeline/sinks/window.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/stream_name.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

namespace eventide::app {

namespace {

std::unique_ptr<Sink> open_folder(const std::string& path, const RunSettings& settings,
                                  const SinkPlan& plan) {
    return std::make_unique<FolderSink>(
        FolderSettings{path, settings.overwrite, settings.uncertainty, float(settings.sigma_white),
                       settings.events, plan.questions.lost, plan.questions.run_json});
}

std::unique_ptr<Sink> open_video(const std::string& path, const RunSettings& settings,
                                 const SinkPlan& plan) {
    const VideoKind& kind = video_kind_of(path);
    if (kind.extension == std::string_view{".mkv"})
        spdlog::warn("{}: Matroska rounds times to 1 ms; MP4 keeps microseconds", path);
    if (kind.ticks_per_second == 0 && !plan.constant_rate)
        spdlog::warn(
            "{}: frames come at no constant rate, and Motion JPEG shows them at {} a second; "
            "--fps with a number, or MP4, keeps their times",
            path, plan.fps);
    return std::make_unique<VideoSink>(VideoSettings{
        path, settings.overwrite, settings.uncertainty, float(settings.sigma_white),
        settings.video_preset, settings.video_crf, plan.fps, settings.slow, settings.events,
        shown_part(settings, plan.sensor), plan.questions.stopping, plan.questions.unread});
}

std::unique_ptr<Sink> open_stream(const std::string& path, StreamFormat format,
                                  const RunSettings& settings, const SinkPlan& plan) {
    StreamSettings stream;
    stream.path = path;
    stream.format = format;
    stream.overwrite = settings.overwrite;
    stream.uncertainty = settings.uncertainty;
    stream.sigma_white = float(settings.sigma_white);
    stream.fps = plan.fps;
    stream.rate = plan.rate;
    stream.stamp = settings.stamp;
    stream.overload = plan.constant_rate ? settings.overload : Overload::skip;
    stream.live = plan.live;
    stream.give_up = plan.questions.stopping;
    stream.unread = plan.questions.unread;
    const std::string name = output_name(path);
    if (!plan.constant_rate && is_y4m(format))
        spdlog::warn(
            "{}: frames come at no constant rate, and what reads Y4M shows them at {} a second; "
            "--fps with a number, or MP4, keeps their times",
            name, plan.fps);
    stream.shorter_by = [name, fps = plan.fps](std::uint64_t frames) {
        spdlog::warn(
            "{}: its reader was slower than {} frames/s, and got {} fewer than the time they show; "
            "--stamp tells each frame's time",
            name, fps, counted(frames, "frame"));
    };
    return std::make_unique<StreamSink>(std::move(stream));
}

std::unique_ptr<Sink> open_window(const RunSettings& settings, const SinkPlan& plan) {
    WindowSettings window;
    window.title = "eventide: " + settings.source;
    window.uncertainty = settings.uncertainty;
    window.sigma_white = float(settings.sigma_white);
    window.speed = plan.speed;
    window.speed_changed = plan.questions.speed_changed;
    window.give_up = plan.questions.stopping;
    window.events = settings.events;
    window.part = shown_part(settings, plan.sensor);
    return std::make_unique<WindowSink>(std::move(window));
}

std::unique_ptr<Sink> open_v4l2(const std::string& node, const RunSettings& settings) {
    V4l2OutputSettings loopback;
    loopback.node = node;
    loopback.uncertainty = settings.uncertainty;
    loopback.sigma_white = float(settings.sigma_white);
    return std::make_unique<V4l2OutputSink>(std::move(loopback));
}

/// Others of this machine need no token, since what they can see they could start themselves.
std::string token_of(const RunSettings& settings, const HttpAddress& address) {
    if (settings.http_token == "none") return {};
    if (settings.http_token != "auto") return settings.http_token;
    return is_loopback(address.host) ? std::string{} : make_token();
}

std::string own_name() {
    char name[256] = {};
    return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

std::unique_ptr<Sink> open_page(const std::string& address, const RunSettings& settings,
                                const SinkPlan& plan) {
    HttpSettings page;
    page.address = parse_http_address(address);
    page.token = token_of(settings, page.address);
    page.names = settings.http_name;
    if (!is_loopback(page.address.host)) page.names.push_back(own_name());
    page.title = settings.source;
    page.uncertainty = settings.uncertainty;
    page.sigma_white = float(settings.sigma_white);
    page.controls = plan.controls;
    page.snapshot = plan.questions.snapshot;
    page.stats = plan.questions.stats;
    page.give_up = plan.questions.stopping;
    const std::string token = page.token;
    auto sink = open_http(std::move(page));
    spdlog::info("live page: {}{}", url_of(sink->address()),
                 token.empty() ? "" : "?token=" + token);
    if (!is_loopback(sink->address().host) && token.empty())
        spdlog::warn("--http-token none: whoever reaches {} may look and change the controls",
                     url_of(sink->address()));
    return sink;
}

std::unique_ptr<Sink> open_ros2(const std::string& name, const RunSettings& settings,
                                const SinkPlan& plan) {
    const Uncertainty how = settings.uncertainty;
    if (how != Uncertainty::automatic && how != Uncertainty::none && how != Uncertainty::separate)
        throw Error(ErrorKind::usage, "--out ros2:" + name +
                                          ": expected --uncertainty auto, none "
                                          "or separate, found " +
                                          std::string{name_of(how)} +
                                          "; sigma is a topic of its own");
    Ros2SinkSettings ros2;
    ros2.name = parse_ros2_sink_name(name);
    if (plan.undistortion) {
        if (!ros2.name.calibration.empty())
            throw Error(ErrorKind::usage, "--out ros2:" + name +
                                              ": calibration=" + ros2.name.calibration +
                                              " and --undistort " + settings.undistort +
                                              ": expected one of them; camera_info tells what the "
                                              "undistorted frames are");
        ros2.calibration = undistorted_sensor(*plan.undistortion);
    }
    ros2.with_sigma = how != Uncertainty::none;
    ros2.geometry = image_geometry(settings, plan.sensor);
    ros2.live = plan.live;
    ros2.give_up = plan.questions.stopping;
    ros2.say = [](const std::string& text) { spdlog::info("{}", text); };
    ros2.warn = [](const std::string& text) { spdlog::warn("{}", text); };
    ros2.detail = [](const std::string& text) { spdlog::debug("{}", text); };
    return open_ros2_sink(std::move(ros2));
}

std::unique_ptr<Sink> open_sheet(const std::string& path, const RunSettings& settings,
                                 const SinkPlan& plan) {
    ContactSheetSettings sheet;
    sheet.path = path;
    sheet.overwrite = settings.overwrite;
    sheet.sigma_white = float(settings.sigma_white);
    sheet.rows = settings.sheet_rows;
    sheet.give_up = plan.questions.stopping;
    sheet.unread = plan.questions.unread;
    sheet.truth_caption = plan.reference_caption;
    sheet.part = rendered_part(settings, plan.sensor, plan.undistortion);
    // Beside frames in colour, else in grey.
    const auto shows =
        settings.colour ? ReferenceImages::Shows::colours : ReferenceImages::Shows::grey;
    if (plan.references != nullptr)
        sheet.draw_truth = [references = plan.references, sensor = plan.sensor, shows](
                               SensorTime t, const Window& window, cv::Mat& image) {
            references->draw_nearest(t, window, {sensor.width, sensor.height}, shows, image);
        };
    return std::make_unique<ContactSheetSink>(std::move(sheet));
}

bool takes_colour(const SinkName& sink) {
    switch (sink.kind) {
        case SinkKind::stream:
            return sink.format == StreamFormat::y4m;
        case SinkKind::video:
            return video_kind_of(sink.path).colour;
        case SinkKind::v4l2:
        case SinkKind::ros2:
            return false;
        case SinkKind::window:
        case SinkKind::folder:
        case SinkKind::sheet:
        case SinkKind::http:
        case SinkKind::nothing:
            break;
    }
    return true;
}

std::unique_ptr<Sink> open_sink(const std::string& text, const RunSettings& settings,
                                const SinkPlan& plan) {
    const SinkName sink = parse_sink(text);
    if (settings.colour && !takes_colour(sink))
        throw Error(ErrorKind::usage,
                    "--out " + text +
                        ": has no colour; with --colour expected a folder, a video, "
                        "y4m:, window, http:, contact-sheet: or null");
    switch (sink.kind) {
        case SinkKind::window:
            return open_window(settings, plan);
        case SinkKind::folder:
            return open_folder(sink.path, settings, plan);
        case SinkKind::video:
            return open_video(sink.path, settings, plan);
        case SinkKind::stream:
            return open_stream(sink.path, sink.format, settings, plan);
        case SinkKind::sheet:
            return open_sheet(sink.path, settings, plan);
        case SinkKind::v4l2:
            return open_v4l2(sink.path, settings);
        case SinkKind::http:
            return open_page(sink.path, settings, plan);
        case SinkKind::ros2:
            return open_ros2(sink.path, settings, plan);
        case SinkKind::nothing:
            break;
    }
    return std::make_unique<NullSink>();
}

std::vector<std::unique_ptr<Sink>> one(std::unique_ptr<Sink> sink) {
    std::vector<std::unique_ptr<Sink>> sinks;
    sinks.push_back(std::move(sink));
    return sinks;
}

}  // namespace

bool is_window(const std::string& sink) {
    return sink == "window";
}

bool is_contact_sheet(const std::string& sink) {
    return sink.starts_with("contact-sheet:");
}

bool is_http(const std::string& sink) {
    return sink.starts_with("http:");
}

std::vector<std::unique_ptr<Sink>> open_sinks(const RunSettings& settings, const SinkPlan& plan) {
    std::vector<std::unique_ptr<Sink>> plain, changed;
    AdjustSettings adjust = settings.adjust;
    adjust.unsharp = float(settings.unsharp);
    for (const bool folders : {true, false})  // first those: others may lie in one
        for (const std::string& sink : settings.out)
            if (folders == (parse_sink(sink).kind == SinkKind::folder))
                (is_contact_sheet(sink) ? plain : changed)
                    .push_back(open_sink(sink, settings, plan));
    if (changed.empty()) return plain;
    if (!adjust.changes_nothing())
        changed = one(std::make_unique<AdjustSink>(adjust, std::move(changed)));
    if (plan.undistortion)
        changed = one(std::make_unique<UndistortionSink>(*plan.undistortion, std::move(changed)));
    std::ranges::move(changed, std::back_inserter(plain));
    return plain;
}

}  // namespace eventide::app
