// The table behind `eventide run`: its groups, and those that say which frames, and how fast.
#include "apps/cli/settings/run_settings.h"

#include "src/binning/slicer_settings.h"
#include "src/core/error.h"
#include "src/core/sensor_limits.h"
#include "src/settings/setting.h"

#include <cmath>

namespace eventide::app {

namespace {

constexpr int kMaxPixels = kLargestFrameSide;  // each way, of an output
constexpr double kLeastScale = 0.01, kMostScale = 64;

FpsChoice parse_fps(const std::string& text) {
    if (text == "auto") return {};
    if (text == "frame") return {false, {}};
    return {false, parse_frame_rate(text)};
}

std::string show_fps(const FpsChoice& fps) {
    if (fps.automatic) return "auto";
    if (!fps.rate.is_set()) return "frame";
    return std::to_string(fps.rate.frames) +
           (fps.rate.seconds == 1 ? "" : "/" + std::to_string(fps.rate.seconds));
}

SizeChoice parse_size_choice(const std::string& text) {
    try {
        if (!text.ends_with('x')) return {1, parse_size(text)};
        return {parse_number(text.substr(0, text.size() - 1), kLeastScale, kMostScale), {}};
    } catch (const Error&) {
        throw_usage("a factor from " + show_number(kLeastScale) + "x to " +
                        show_number(kMostScale) + "x, or pixels such as 640x480, each from 1 to " +
                        std::to_string(kMaxPixels),
                    text);
    }
}

std::string show_size_choice(const SizeChoice& size) {
    return size.exact ? show_size(*size.exact) : show_number(size.scale) + "x";
}

/// "10,20,100x50"
Region parse_region(const std::string& text) {
    const std::size_t first = text.find(','), second = text.find(',', first + 1);
    if (first == text.npos || second == text.npos)
        throw_usage("a region such as 10,20,100x50 (x,y,WxH)", text);
    const Size size = parse_size(text.substr(second + 1));
    return {parse_whole(text.substr(0, first), 0, kMaxPixels),
            parse_whole(text.substr(first + 1, second - first - 1), 0, kMaxPixels), size.width,
            size.height};
}

std::string show_region(const Region& region) {
    return std::to_string(region.x) + "," + std::to_string(region.y) + "," +
           show_size({region.width, region.height});
}

std::string check_window(const std::string& text) {
    if (text != "model") parse_window(text);
    return text;
}

std::string check_speed(const std::string& text) {
    if (text != "auto" && text != "max") {
        try {
            parse_number(text, 0.001, 1000);
        } catch (const Error&) {
            throw_usage("auto, max or a factor from 0.001 to 1000", text);
        }
    }
    return text;
}

}  // namespace

Size SizeChoice::of(const Size& sensor) const {
    if (exact) return *exact;
    const Size size{int(std::lround(sensor.width * scale)),
                    int(std::lround(sensor.height * scale))};
    if (size.width < 1 || size.height < 1 || size.width > kMaxPixels || size.height > kMaxPixels)
        throw Error(ErrorKind::usage, "--size " + show_size_choice(*this) + ": a sensor of " +
                                          show_size(sensor) + " would give " + show_size(size) +
                                          "; expected 1 to " + std::to_string(kMaxPixels) +
                                          " each way");
    return size;
}

SettingTable RunSettings::table() {
    SettingTable table{"run", "eventide run: a recording or camera in, frames and sigma out.", {}};
    add_times(table);
    table.group_rest("Frames");
    add_outputs(table);
    table.group_rest("Output");
    add_adjustments(table);
    table.group_rest("Post-processing");
    add_quality(table);
    table.group_rest("Quality");
    add_network(table);
    table.group_rest("Network");
    input.add_to(table);
    table.group_rest("Input");
    add_machinery(table);
    table.group_rest("Cameras and buffers");
    return table;
}

/// Which frames of which part of the recording.
void RunSettings::add_times(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(parsed_setting<FpsChoice>("fps", fps, "RATE",
                                  "Frames per second of the video: 120, 29.97, 30000/1001. Without "
                                  "--slow, video time is sensor time. frame: one at the end of "
                                  "each event window; auto: frame with --window aps, else 30.",
                                  parse_fps, show_fps));
    add(number_setting("slow", slow, "N",
                       "Slow motion: the video takes N times as long as what it shows, with --fps "
                       "frames in each of its seconds.",
                       0.001, 100'000));
    add(noted(parsed_setting<SizeChoice>("size", size, "2x|640x480",
                                         "Size of the frames: a factor of the sensor's, or pixels.",
                                         parse_size_choice, show_size_choice),
              size_given));
    add(open_setting<Region>(
        "roi", region, "X,Y,WxH",
        "Render only this part of the frame, in pixels of the frame; all: everything.", "all",
        parse_region, show_region));
    add(open_setting<int>(
        "lookahead", lookahead, "auto|0|1|2",
        "Event windows a frame waits for: more give higher quality and more latency. auto: 0 for "
        "live sources, 2 "
        "for recordings.",
        "auto", [](const std::string& text) { return parse_whole(text, 0, kMaxLookahead); },
        [](const int& n) { return std::to_string(n); }));
    add(parsed_setting<std::string>(
        "window", window, "WINDOW",
        "How events are cut into event windows: 50ms (constant time), 20000ev (constant number), "
        "0.35epp (events per pixel), aps (between reference images); after a comma the maximum "
        "width: 20000ev,200ms. model: what the model was trained for. auto: by content, short "
        "where much moves and 100 ms at most (auto,50ms,5ms: 50 at most, 5 at least); of live "
        "sources no longer than model, and no shorter than the pace allows.",
        check_window, same_text));
    add(parsed_setting<std::string>(
        "speed", speed, "FACTOR",
        "Playback speed of a recording: max (as fast as possible), 1 (as it was recorded), 0.25, "
        "...; auto: with a window or page as recorded, or as --slow says, else max.",
        check_speed, same_text));
    add(time_point_setting(
        "from", from, "start",
        "First frame: 2.5s or 20ms after the first event, or @MICROSECONDS of the sensor; start: "
        "the beginning."));
    add(time_point_setting("to", to, "end", "Last frame, written as --from; end: the end."));
    add(open_setting<SensorDuration>(
        "warmup", warmup, "TIME",
        "With --from: begin this much earlier, without frames, so that the network has seen the "
        "scene; auto: 1s, or 0s where --state-in tells what was before.",
        "auto", [](const std::string& text) { return parse_duration(text); },
        [](const SensorDuration& d) { return show_duration(d); }));
    add(flag_setting("allow_silence", allow_silence,
                     "Render more than 1000000 frames in a row without events; such a silence is "
                     "usually a wrong time in the recording."));
    add(open_setting<SensorDuration>(
        "duration", duration, "TIME", "Stop after this much sensor time; all: at the end.", "all",
        [](const std::string& text) { return parse_duration(text); },
        [](const SensorDuration& d) { return show_duration(d); }));
}

/// What holds the pace.
void RunSettings::add_quality(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(choice_setting("quality", quality,
                       "auto: for live sources and with --realtime, whichever of model, precision, "
                       "event windows, size and frame rate is not given is chosen to hold the "
                       "pace; windows, size and rate then follow the load. Every choice is logged. "
                       "fixed: nothing is changed.",
                       {{QualityMode::automatic, "auto"}, {QualityMode::fixed, "fixed"}}));
    add(flag_setting(
        "realtime", realtime,
        "Play a recording as a camera would deliver it: at its own pace, or --speed, with a live "
        "source's --window and --lookahead, and in a quality that holds the pace."));
    add(parsed_setting<Budget>(
        "budget", budget, "TIME|SHARE%",
        "Processor time the network may take: 8ms for each frame that --fps asks for, or 50% of a "
        "core; the quality is chosen by it. none: as much as holds the pace.",
        parse_budget, show_budget));
}

}  // namespace eventide::app
