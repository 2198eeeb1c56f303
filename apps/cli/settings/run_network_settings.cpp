// The part of `eventide run`'s table that says with which network, and which buffers around it.
#include "apps/cli/settings/run_settings.h"
#include "apps/cli/settings/words.h"
#include "src/settings/setting.h"

namespace eventide::app {

namespace {

/// A number of buffers, or auto.
template <int kMost>
Setting buffers_setting(std::string key, std::optional<int>& value, std::string help) {
    return open_setting<int>(
        std::move(key), value, "N", std::move(help), "auto",
        [](const std::string& text) { return parse_whole(text, 1, kMost); },
        [](const int& n) { return std::to_string(n); });
}

std::string check_latency(const std::string& text) {
    if (text != "auto" && text != "none" && parse_duration(text) <= SensorDuration{0})
        throw_usage("auto, none or a time above 0", text);
    return text;
}

}  // namespace

/// With which network, and what it remembers.
void RunSettings::add_network(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(noted(path_setting(
                  "model", model, "NAME|FILE",
                  "A name from the models folder (default, small, thesis) or a safetensors file."),
              model_given));
    add(choice_setting(
        "sigma_rule", sigma_rule,
        "How the sigmas of the local ensemble are combined; model: as the model says.",
        sigma_words()));
    add(choice_setting("precision", precision,
                       "Arithmetic precision: auto measures at the start which is faster.",
                       kPrecisionWords));
    add(choice_setting(
        "kernels", kernels,
        "Whose convolutions the fast engine calls: auto takes what pays best on this "
        "processor; own (built-in kernels) or onednn give bit-identical results.",
        kKernelWords));
    add(choice_setting("engine", engine, "plain is the readable reference, fast the usual one.",
                       kEngineWords));
    add(whole_setting("threads", threads, "N",
                      "Threads the network may use; 0: as many as this process may run on.", 0,
                      kMaxThreads));
    add(self_ensemble_setting(self_ensemble,
                              "Average the frames of so many networks that see the scene "
                              "mirrored: a smaller error for that many times the work."));
    add(path_setting("state_in", state_in, "FILE",
                     "Continue from the state that an earlier run saved: the network's "
                     "(--state-out) or the complete one (--states-out)."));
    add(path_setting("state_out", state_out, "FILE", "Save the network's state at the end."));
    add(path_setting("states_out", states_out, "FOLDER",
                     "Save the complete state of the run at each time of --states-at, on one "
                     "thread: a run with such a file as --state-in gives the frames of one "
                     "uninterrupted run. Without --out nothing is rendered."));
    add(list_setting("states_at", states_at, "TIME...",
                     "Times for --states-out, in a recording, ascending, written as --from."));
    add(choice_setting(
        "frames", frames,
        "The camera's own images (APS): auto and use correct the frames by them, for as long as "
        "what they show is valid; use warns if none came; ignore does not use them.",
        {{CameraFrames::automatic, "auto"},
         {CameraFrames::use, "use"},
         {CameraFrames::ignore, "ignore"}}));
    add(bayer_setting(bayer,
                      "The sensor's colour filter, from its top left corner; auto: what the camera "
                      "or recording says. Its images are demosaiced; none: they are no mosaics."));
    add(flag_setting("colour", colour,
                     "Frames in colour, of a sensor with a colour filter: folders, videos, Y4M, "
                     "window and page."));
    add(flag_setting("reset_on_gap", reset_on_gap,
                     "Reset the recurrent state where data were lost, instead of keeping it."));
}

/// Cameras, and the numbers of buffers.
void RunSettings::add_machinery(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(parsed_setting<std::string>(
        "latency", latency, "TIME",
        "How late frames of a live source may be. What does not fit is left out, in this order: "
        "single frames, half of the frame rate, event windows (merged into one), packets. none: as "
        "late as the buffers allow; auto: 250ms.",
        check_latency, same_text));
    add(path_setting("camera", camera, "FILE",
                     "Camera settings: a file as in config/cameras; for v4l2: also a .bias or JSON "
                     "file of Metavision."));
    add(flag_setting("reconnect", reconnect, "Wait for an unplugged camera to come back."));
    add(buffers_setting<1 << 16>(
        "buffers_packets", buffers_packets,
        "Packets between reading and binning: the burst a live source may send; "
        "auto: 64, and of a camera with small transfers as many as hold 8 MiB. A "
        "recording, which waits, uses at most 8."));
    add(buffers_setting<1024>(
        "buffers_grids", buffers_grids,
        "Event windows between binning and the network; auto: 3 for a live source, "
        "2 for a recording."));
    add(buffers_setting<1024>(
        "buffers_latents", buffers_latents,
        "Event windows between the network and rendering: more bridge longer bursts and allow more "
        "latency. auto: 3 for a live source, 2 for a recording."));
    add(flag_setting("sequential", sequential,
                     "Everything on one thread: the same frames, for comparison."));
}

}  // namespace eventide::app
