// SINK on the command line becomes a sink of frames.
#pragma once

#include "apps/cli/run/reference_images.h"
#include "apps/cli/settings/run_settings.h"
#include "pipeline/calibration/undistortion.h"
#include "pipeline/counters.h"
#include "pipeline/sink.h"
#include "pipeline/sinks/http/control.h"
#include "src/io/output_file.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide::app {

/// What sinks ask of the run while it goes on; any member may be empty. Render thread.
struct SinkQuestions {
    std::function<std::uint64_t()> lost;
    std::function<std::string()> run_json;
    std::function<bool()> stopping;
    std::function<void(const std::string& name, PipeReader)> unread;  ///< as OutputOptions has it
    std::function<void(double)> speed_changed;
    // Any thread.
    std::function<Snapshot()> snapshot;
    std::function<std::string(double event_rate)> stats;
};

struct SinkPlan {
    double fps = 30;                                    ///< nominal
    FrameRate rate = {};                                ///< the same as a fraction; none: not known
    bool constant_rate = true;                          ///< and no frame for each event window
    double speed = 1;                                   ///< of the recording, for the window
    Size sensor;                                        ///< px
    bool live = false;                                  ///< the source is a camera
    std::optional<UndistortionPlan> undistortion = {};  ///< empty: not asked for
    ReferenceImages* references = nullptr;
    std::string reference_caption;  ///< for people
    SinkQuestions questions;
    std::vector<HttpControl> controls = {};  ///< of the live page
};

bool is_window(const std::string& sink);
bool is_contact_sheet(const std::string& sink);
bool is_http(const std::string& sink);

/// Opens all of settings.out, with undistortion and the look controls in front of all but the
/// contact sheet. Throws Error (usage) for what names no sink or contradicts --uncertainty.
std::vector<std::unique_ptr<Sink>> open_sinks(const RunSettings& settings, const SinkPlan& plan);

}  // namespace eventide::app
