// The table behind `eventide run`: names, defaults, meaning, and how each value is written.
#include "apps/cli/settings/run_settings.h"

#include "src/binning/noise_filter.h"
#include "src/binning/slicer_settings.h"

#include <algorithm>
#include <cmath>

namespace eventide::app {

namespace {

constexpr int kMaxPixels = kLargestFrameSide;  // each way, of an output

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
    if (!text.ends_with('x')) return {1, parse_size(text)};
    try {
        return {parse_number(text.substr(0, text.size() - 1), 0.01, 64), {}};
    } catch (const Error&) {
        throw_usage("a size such as 2x, 2.5x or 640x480", text);
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

/// A setting that may be left open, written as `word`.
template <typename T>
Setting open_setting(std::string key, std::optional<T>& value, std::string value_name,
                     std::string help, std::string word, T (*parse)(const std::string&),
                     std::string (*show)(const T&)) {
    return parsed_setting<std::optional<T>>(
        std::move(key), value, std::move(value_name), std::move(help),
        [word, parse](const std::string& text) {
            return text == word ? std::nullopt : std::optional<T>{parse(text)};
        },
        [word, show](const std::optional<T>& v) { return v ? show(*v) : word; });
}

/// A number of buffers, or auto.
Setting buffers_setting(std::string key, std::optional<int>& value, std::string help) {
    return open_setting<int>(
        std::move(key), value, "N", std::move(help), "auto",
        [](const std::string& text) { return parse_whole(text, 1, 1024); },
        [](const int& n) { return std::to_string(n); });
}

/// The same setting, which notes that somebody gave the value.
Setting noted(Setting setting, bool& given) {
    setting.set = [set = std::move(setting.set), &given](const std::vector<std::string>& texts) {
        set(texts);
        given = true;
    };
    return setting;
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

std::string check_latency(const std::string& text) {
    if (text != "auto" && text != "none" && parse_duration(text) <= SensorDuration{0})
        throw_usage("auto, none or a time above 0", text);
    return text;
}

/// It is written into addresses as it is.
std::string check_token(const std::string& text) {
    const auto plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_' || c == '.' || c == '~';
    };
    if (text.empty() || !std::ranges::all_of(text, plain))
        throw_usage("auto, none, or letters, digits and - . _ ~", text);
    return text;
}

std::string same(const std::string& text) {
    return text;
}

ColourFilter parse_bayer(const std::string& text) {
    return ColourFilter(parse_choice(text, {"none", "rggb", "grbg", "gbrg", "bggr"}));
}

std::string check_hot_pixels(const std::string& text) {
    if (text.empty()) throw_usage("off, learn or a file", text);
    return text;
}

std::string check_noise_filter(const std::string& text) {
    parse_noise_filter(text, false);
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
    add_look(table);
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
    add(parsed_setting<FpsChoice>(
        "fps", fps, "RATE",
        "Frames per second of the video, which without --slow is sensor time: 120, 29.97, "
        "30000/1001; frame: one at the end of each event window; auto: frame with --window aps, "
        "else 30.",
        parse_fps, show_fps));
    add(number_setting("slow", slow, "N",
                       "Slow motion: the video takes N times as long as what it shows, with --fps "
                       "frames in each of its seconds.",
                       0.001, 100'000));
    add(noted(parsed_setting<SizeChoice>("size", size, "2x|640x480",
                                         "Size of the frames: a factor of the sensor's, or pixels.",
                                         parse_size_choice, show_size_choice),
              size_given));
    add(open_setting<Region>("roi", region, "X,Y,WxH",
                             "Render only this part of the frame, in its pixels; all: everything.",
                             "all", parse_region, show_region));
    add(open_setting<int>(
        "lookahead", lookahead, "0|1|2",
        "Event windows a frame waits for: more give higher quality and more latency. auto: 0 for "
        "live sources, 2 "
        "for recordings.",
        "auto", [](const std::string& text) { return parse_whole(text, 0, 2); },
        [](const int& n) { return std::to_string(n); }));
    add(parsed_setting<std::string>(
        "window", window, "WINDOW",
        "How events are cut into event windows: 50ms (constant time), 20000ev (constant number), "
        "0.35epp (events per pixel), aps (between reference images); after a comma the maximum "
        "width: 20000ev,200ms. model: what the model was trained for. auto: by content for "
        "recordings, short where much moves and 50 ms at most; model for live sources.",
        check_window, same));
    add(parsed_setting<std::string>("speed", speed, "FACTOR",
                                    "Of a recording: max (as fast as possible), 1 (as it was "
                                    "recorded), 0.25, ...; auto: with a window or page as "
                                    "recorded, or as --slow says, else max.",
                                    check_speed, same));
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
                       "auto: of live sources and with --realtime, model, precision, size and rate "
                       "of frames that are not given are chosen so that they hold the pace, and "
                       "size and rate changed with the load; each is said. fixed: nothing is "
                       "changed.",
                       {"auto", "fixed"}));
    add(flag_setting("realtime", realtime,
                     "A recording as if a camera gave it: at its own pace, or --speed, with a live "
                     "source's --window and --lookahead, and of the quality that holds the pace."));
    add(parsed_setting<Budget>(
        "budget", budget, "TIME|SHARE%",
        "Processor time the network may take: 8ms for each frame that --fps asks for, or 50% of a "
        "core; the quality is chosen by it. none: as much as holds the pace.",
        parse_budget, show_budget));
}

/// With which network, and what it remembers.
void RunSettings::add_network(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(noted(text_setting(
                  "model", model, "NAME|FILE",
                  "A name from the models folder (default, small, thesis) or a safetensors file."),
              model_given));
    add(choice_setting("sigma_rule", sigma_rule,
                       "How the members of the local ensemble give one sigma; model: as the model "
                       "says.",
                       {"model", "log_blend", "mixture"}));
    add(choice_setting("precision", precision,
                       "Arithmetic precision: auto measures at the start which is faster.",
                       {"auto", "f32", "bf16"}));
    add(choice_setting(
        "kernels", kernels,
        "Whose convolutions the fast engine calls: auto takes what pays best on this "
        "processor; own (built-in kernels) or onednn give bit-identical results.",
        {"auto", "own", "onednn"}));
    add(choice_setting("engine", engine, "plain is the readable reference, fast the usual one.",
                       {"plain", "fast"}));
    add(whole_setting("threads", threads, "N",
                      "Threads the network may use; 0: as many as this process may run on.", 0,
                      1024));
    add(text_setting("state_in", state_in, "FILE",
                     "Go on from the network's state that an earlier run saved."));
    add(text_setting("state_out", state_out, "FILE", "Save the network's state at the end."));
    add(choice_setting("frames", frames,
                       "The camera's own images (APS): auto and use correct the frames by them, "
                       "for as long as what they "
                       "show holds; use says so where none came; ignore leaves them alone.",
                       {"auto", "use", "ignore"}));
    add(open_setting<ColourFilter>(
        "bayer", bayer, "none|rggb|grbg|gbrg|bggr",
        "The sensor's colour filter, from its top left corner; auto: what the camera or recording "
        "says. Its images are demosaiced.",
        "auto", parse_bayer, [](const ColourFilter& f) { return std::string{name_of(f)}; }));
    add(flag_setting("colour", colour,
                     "Frames in colour, of a sensor with a colour filter: folders, videos, Y4M, "
                     "window and page."));
    add(flag_setting("reset_on_gap", reset_on_gap,
                     "Reset the recurrent state where data were lost, instead of keeping it."));
}

/// To where.
void RunSettings::add_outputs(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    Setting sinks = list_setting(
        "out", out, "SINK",
        "Where frames go, any number of times: dir/ (PNG, TIFF, times), x.mp4, x.mkv, x.avi, "
        "x.gif, x.y4m, - "
        "(Y4M on standard output), y4m:, y4m-mono:, gray8:, gray16: or grayf32: and a file, pipe "
        "or "
        "-, window, http:127.0.0.1:8080 (a page in the browser, MJPEG), ros2:/NAME (ROS 2 topics), "
        "v4l2:/dev/videoN (a virtual camera), contact-sheet:x.png, null.");
    sinks.short_flag = "-o";
    add(std::move(sinks));
    add(flag_setting("overwrite", overwrite,
                     "Replace files that exist; of a folder, what an earlier run wrote."));
    add(flag_setting("force", force,
                     "Write frames to standard output even where it is a terminal."));
    add(flag_setting("stamp", stamp,
                     "Raw streams: 16 bytes before each frame with its number, its time in "
                     "microseconds and what happened (docs/usage.md). Y4M has the time anyway."));
    add(choice_setting("overload", overload,
                       "What a stream of constant rate has in place of a skipped frame: the one "
                       "before again, so that it keeps its pace, or nothing.",
                       {"repeat", "skip"}));
    add(choice_setting(
        "uncertainty", uncertainty,
        "How sigma is shown: separate (TIFF in the folder, a second video, a second plane), side, "
        "alpha, overlay, none; auto: TIFF in the folder, else none. The folder keeps its TIFFs "
        "except with none.",
        {"auto", "none", "separate", "side", "alpha", "overlay"}));
    add(number_setting("sigma_white", sigma_white, "SIGMA",
                       "The sigma (of intensity 0 to 1) that is shown as white, full red or clear.",
                       0.001, 100));
    add(flag_setting("events", events,
                     "Show the events of each frame's event window: left in the window and in "
                     "videos, as events/*.png in the folder. The contact sheet and the live page "
                     "always do."));
    add(parsed_setting<std::string>(
        "http_token", http_token, "TOKEN",
        "What viewers of the live page have to know. auto: nothing on this machine alone, "
        "else one that is made and told; none: nothing.",
        check_token, same));
    add(list_setting("http_name", http_name, "NAME",
                     "A name under which browsers reach the live page (of a proxy, for example); "
                     "others are refused, except localhost and addresses."));
    add(text_setting("record", record, "FILE",
                     "Also write what the source sends, before anything can be lost: in the format "
                     "of the extension, or untouched bytes as .bin."));
    add(text_setting("events_out", events_out, "TO",
                     "Also write the events behind all filters: in the format of the extension, "
                     "as FORMAT:PATH (a pipe, or - for standard output), folder/, or "
                     "udp://HOST:PORT."));
    add(text_setting("stats", stats, "FILE",
                     "Counters as JSON, a line each second and a last one with \"final\": true."));
    add(flag_setting("strict", strict, "End with exit code 5 when data were lost or damaged."));
}

/// How it is to look.
void RunSettings::add_look(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(filter_setting(filter));
    add(parsed_setting<std::string>(
        "hot_pixels", hot_pixels, "off|learn|FILE",
        "Leave out hot pixels: learn finds them while it runs, a file lists "
        "them, one x,y a line.",
        check_hot_pixels, same));
    add(parsed_setting<std::string>(
        "noise_filter", noise_filter, "model|auto|off|TIME",
        "Leave out noise: events that fewer than two of the eight pixels around them support "
        "within TIME. auto: 10 to 500 ms, by the noise that is found, more where nothing moves, "
        "and hot pixels; model: as the model was trained.",
        check_noise_filter, same));
    add(text_setting(
        "undistort", undistort, "FILE",
        "Undistort the frames: YAML of ROS' camera_calibration or Kalibr's camchain, for "
        "the whole sensor. The contact sheet stays as the camera sees it."));
    add(text_setting("undistort_camera", undistort_camera, "NAME",
                     "Of a Kalibr file with several cameras: cam1; without it, the first."));
    add(flag_setting("auto_hdr", look.auto_hdr,
                     "Stretch the range the frame uses to black and white, smoothed in time; "
                     "sigma is scaled with it."));
    add(number_setting("unsharp", unsharp, "AMOUNT", "Sharpen: 0 is off, 0.3 is moderate.", 0, 10));
    add(choice_setting("flip", look.flip, "Mirror the frame.",
                       {"none", "horizontal", "vertical", "both"}));
    add(whole_setting("crop", look.crop_px, "PIXELS", "Crop this many pixels at each side.", 0,
                      kMaxPixels));
    add(text_setting("video_preset", video_preset, "PRESET",
                     "x264's preset: ultrafast to veryslow; slower is smaller."));
    add(whole_setting("video_crf", video_crf, "CRF",
                      "x264's quality: 0 is lossless, 18 looks so, 51 is worst.", 0, 51));
    add(whole_setting("sheet_rows", sheet_rows, "N", "Rows of the contact sheet.", 1, 100));
}

/// Cameras, and the numbers of buffers.
void RunSettings::add_machinery(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(parsed_setting<std::string>(
        "latency", latency, "TIME",
        "Of a live source: how late frames may be. What does not fit is left out, in this order: "
        "frames, half of their rate, event windows (merged into one), packets. none: as late as "
        "the buffers allow; auto: 250ms.",
        check_latency, same));
    add(text_setting("camera", camera, "FILE", "Settings of a camera, as in config/cameras."));
    add(flag_setting("reconnect", reconnect, "Wait for an unplugged camera to come back."));
    add(whole_setting(
        "buffers_packets", buffers_packets, "N",
        "Packets between reading and binning: the burst a live source may send. Of a recording, "
        "which waits, at most 8.",
        1, 1 << 16));
    add(buffers_setting("buffers_grids", buffers_grids,
                        "Event windows between binning and the network; auto: 3 of a live source, "
                        "2 of a recording."));
    add(buffers_setting(
        "buffers_latents", buffers_latents,
        "Event windows between the network and rendering: more bridge longer bursts "
        "and allow more latency. auto: 3 of a live source, 2 of a recording."));
    add(flag_setting("sequential", sequential,
                     "Everything on one thread: the same frames, for comparison."));
}

}  // namespace eventide::app
