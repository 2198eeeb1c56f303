// The part of `eventide run`'s table that says where frames go and how they look.
#include "apps/cli/settings/run_settings.h"
#include "src/binning/flicker_pairs.h"
#include "src/binning/noise_filter.h"
#include "src/settings/setting.h"

#include <algorithm>

namespace eventide::app {

namespace {

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

std::string check_hot_pixels(const std::string& text) {
    if (text.empty()) throw_usage("off, learn or a file", text);
    return text;
}

std::string check_lamp_flicker(const std::string& text) {
    parse_lamp_flicker(text, false);
    return text;
}

std::string check_noise_filter(const std::string& text) {
    parse_noise_filter(text, false);
    return text;
}

/// As name_of() has them.
std::vector<Word<Flip>> flip_words() {
    std::vector<Word<Flip>> words;
    for (const Flip flip : {Flip::none, Flip::horizontal, Flip::vertical, Flip::both})
        words.push_back({flip, name_of(flip)});
    return words;
}

}  // namespace

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
    add(choice_setting(
        "overload", overload,
        "What a stream of constant rate contains in place of a skipped frame: the "
        "previous one again, so that it keeps its pace as far as its reader does, "
        "or nothing; auto: nothing with --stamp, which tells each frame's time.",
        {{Overload::automatic, "auto"}, {Overload::repeat, "repeat"}, {Overload::skip, "skip"}}));
    add(choice_setting(
        "uncertainty", uncertainty,
        "How sigma is shown: separate (TIFF in the folder, a second video, a second plane), side, "
        "alpha, overlay, none; auto: TIFF in the folder, else none. The folder keeps its TIFFs "
        "except with none.",
        {{Uncertainty::automatic, "auto"},
         {Uncertainty::none, "none"},
         {Uncertainty::separate, "separate"},
         {Uncertainty::side, "side"},
         {Uncertainty::alpha, "alpha"},
         {Uncertainty::overlay, "overlay"}}));
    add(number_setting("sigma_white", sigma_white, "SIGMA",
                       "The sigma (of intensity 0 to 1) that is shown as white, full red or clear.",
                       0.001, 100));
    add(flag_setting(
        "events", events,
        "Show the events of each frame's event window: left of the frame in the window and in "
        "videos, as events/*.png in the folder. The contact sheet and the live page always do."));
    add(parsed_setting<std::string>(
        "http_token", http_token, "TOKEN",
        "Token that viewers of the live page must send. auto: no token at an address of this "
        "machine only, else one that is generated and logged; none: no token.",
        check_token, same_text));
    add(list_setting("http_name", http_name, "NAME",
                     "A name under which browsers reach the live page (of a proxy, for example); "
                     "others are refused, except localhost and addresses."));
    add(path_setting("record", record, "FILE",
                     "Also write what the source sends, before anything can be lost, in the format "
                     "of the extension; .aedat4 holds events, images, IMU samples and triggers."));
    add(path_setting(
        "events_out", events_out, "TO",
        "Also write the events after all filters: in the format of the extension, as FORMAT:PATH "
        "(a pipe, or - for standard output), folder/, or udp://HOST:PORT."));
    add(path_setting("stats", stats, "FILE",
                     "Counters as JSON, a line each second and a last one with \"final\": true."));
    add(flag_setting("strict", strict, "End with exit code 5 when data were lost or damaged."));
}

/// How it is to look.
void RunSettings::add_adjustments(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(filter_setting(filter));
    add(parsed_setting<std::string>(
        "hot_pixels", hot_pixels, "off|learn|FILE",
        "Remove hot pixels: learn finds them during the run, a file lists them, one x,y a line.",
        check_hot_pixels, same_text));
    add(parsed_setting<std::string>(
        "noise_filter", noise_filter, "model|auto|off|TIME",
        "Remove noise: events that fewer than two of the eight pixels around them support within "
        "TIME. auto: 10 to 500 ms by the measured noise, more strictly where nothing moves, and "
        "hot pixels; model: as the model was trained.",
        check_noise_filter, same_text));
    add(parsed_setting<std::string>(
        "lamp_flicker", lamp_flicker, "auto|off|TIME",
        "While light flickers at 80 to 800 Hz, leave out the pairs of on and off events that it "
        "adds. "
        "Events wait as long as the second of a pair may come: TIME; auto: 16 ms of a recording, "
        "three quarters of a period of a camera.",
        check_lamp_flicker, same_text));
    add(path_setting(
        "undistort", undistort, "FILE",
        "Undistort the frames: YAML of ROS' camera_calibration or Kalibr's camchain, for "
        "the whole sensor. The contact sheet stays as the camera sees it."));
    add(text_setting(
        "undistort_camera", undistort_camera, "NAME",
        "Which camera of a Kalibr file with several, such as cam1; empty: the first."));
    add(flag_setting("auto_hdr", adjust.auto_hdr,
                     "Stretch the range the frame uses to black and white, smoothed in time; "
                     "sigma is scaled with it."));
    add(number_setting("unsharp", unsharp, "AMOUNT", "Sharpen: 0 is off, 0.3 is moderate.", 0, 10));
    add(choice_setting("flip", adjust.flip, "Mirror the frame.", flip_words()));
    add(whole_setting("crop", adjust.crop_px, "PIXELS", "Crop this many pixels at each side.", 0,
                      kLargestFrameSide));
    add(text_setting("video_preset", video_preset, "PRESET",
                     "x264's preset: ultrafast to veryslow; slower is smaller."));
    add(whole_setting("video_crf", video_crf, "CRF",
                      "x264's quality: 0 is lossless, 18 looks so, 51 is worst.", 0, 51));
    add(whole_setting("sheet_rows", sheet_rows, "N", "Rows of the contact sheet.", 1, 100));
}

}  // namespace eventide::app
