// Everything `eventide run` can be told.
#pragma once

#include "apps/cli/settings/budget.h"
#include "apps/cli/settings/input_settings.h"
#include "apps/cli/settings/time_point.h"
#include "pipeline/frame_clock.h"
#include "pipeline/sinks/adjust.h"
#include "pipeline/sinks/draw_frame.h"
#include "pipeline/sinks/raw_stream.h"
#include "src/core/bayer.h"
#include "src/model/engine.h"
#include "src/model/render/renderer.h"
#include "src/settings/setting.h"

#include <optional>
#include <string>
#include <vector>

namespace eventide::app {

/// "auto", "frame" (one frame at the end of each event window) or a rate.
struct FpsChoice {
    bool automatic = true;
    FrameRate rate;
};

/// "2.5x" of the sensor's size, or "640x480".
struct SizeChoice {
    double scale = 1;
    std::optional<Size> exact;

    /// The output for a sensor of this size. Throws Error (usage) when it is too large.
    Size of(const Size& sensor) const;
};

/// automatic chooses what is left open where there is a pace to hold.
enum class QualityMode { automatic, fixed };

/// How the members of the local ensemble give one sigma; empty: as the model says.
using SigmaChoice = std::optional<SigmaRule>;

inline std::vector<Word<SigmaChoice>> sigma_words() {
    return {{std::nullopt, "model"},
            {SigmaRule::log_blend, "log_blend"},
            {SigmaRule::mixture, "mixture"}};
}

/// What becomes of the camera's own images: automatic uses them where some come.
enum class CameraFrames { automatic, use, ignore };

struct RunSettings {
    // what
    std::string source;
    InputSettings input;
    std::string camera;  ///< settings file of a camera
    bool reconnect = false;
    std::optional<TimePoint> from, to;
    bool allow_silence = false;
    std::optional<SensorDuration> warmup;  ///< before `from`; empty: as run_plan.cpp says
    std::optional<SensorDuration> duration;
    std::string speed = "auto";    ///< auto, max, or a factor
    std::string latency = "auto";  ///< auto, none, or a time
    double slow = 1;               ///< seconds of video for one of sensor time
    bool realtime = false;         ///< a recording as if a camera gave it

    // how
    QualityMode quality = QualityMode::automatic;
    Budget budget;
    bool model_given = false, size_given = false;  ///< by a flag, the environment or a file
    std::string model = "default";
    std::string window = "auto";
    FpsChoice fps;
    SizeChoice size;
    std::optional<Region> region;
    std::optional<int> lookahead;
    SigmaChoice sigma_rule;
    Precision precision = Precision::automatic;
    Kernels kernels = Kernels::automatic;
    Instructions instructions = Instructions::best;  ///< of `eventide bench`: no option of runs
    Engine engine = Engine::fast;
    int threads = 0;
    int self_ensemble = 1;
    std::string state_in, state_out;
    bool reset_on_gap = false;
    std::optional<ColourFilter> bayer;  ///< empty: what the camera or recording says
    bool colour = false;
    CameraFrames frames = CameraFrames::automatic;
    std::vector<std::string> filter;  ///< make_data_filter(), in this order
    std::string hot_pixels = "off";
    std::string noise_filter = "model";
    std::string lamp_flicker = "auto";  ///< parse_lamp_flicker()

    // to where
    std::vector<std::string> out;
    bool overwrite = false;
    bool force = false;  ///< frames onto a terminal
    bool stamp = false;
    Overload overload = Overload::automatic;
    Uncertainty uncertainty = Uncertainty::automatic;
    double sigma_white = 0.3;  // kSigmaWhite, in fewer digits
    bool events = false;
    std::string http_token = "auto";  ///< auto, none, or the token
    std::vector<std::string> http_name;
    std::string record, events_out;
    std::string stats;
    bool strict = false;

    // look
    std::string undistort;         ///< calibration file; empty: frames stay as the lens makes them
    std::string undistort_camera;  ///< of a Kalibr file; empty: the first
    AdjustSettings adjust;
    double unsharp = 0;
    std::string video_preset = "veryfast";
    int video_crf = 18;
    int sheet_rows = 4;

    // machinery
    std::optional<int> buffers_packets;                 ///< empty: as many as a burst needs
    std::optional<int> buffers_grids, buffers_latents;  ///< empty: 3 of a live source, else 2
    bool sequential = false;
    bool tries_model = true;  ///< no option of runs: where a program has many, of one model

    // for other runs
    std::string states_out;              ///< a folder
    std::vector<std::string> states_at;  ///< parse_time_point(), ascending

    RunSettings() = default;
    RunSettings(const RunSettings&) = delete;  // table() points into it
    RunSettings& operator=(const RunSettings&) = delete;

    SettingTable table();

private:
    void add_times(SettingTable& table);
    void add_quality(SettingTable& table);
    void add_network(SettingTable& table);
    void add_outputs(SettingTable& table);
    void add_adjustments(SettingTable& table);
    void add_machinery(SettingTable& table);
};

}  // namespace eventide::app
