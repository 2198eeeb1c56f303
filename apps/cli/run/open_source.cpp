// SOURCE on the command line becomes a source of bytes.
#include "apps/cli/run/open_source.h"

#include "apps/cli/printable.h"
#include "drivers/devices.h"
#include "drivers/simulated/simulated_camera.h"
#include "replay/formats.h"
#include "src/core/error.h"
#include "src/core/sensor_limits.h"
#include "src/settings/values.h"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

namespace eventide::app {

namespace {

/// "metavision:" is no file that is missing, and "davis" probably none.
void refuse_unknown_source(const std::string& source) {
    std::error_code none;
    if (source == "-" || std::filesystem::exists(source, none)) return;
    const std::string meant = source_suggestion(source);
    const std::size_t colon = source.find(':');
    if (colon != source.npos && source.find('/') > colon)
        throw Error(ErrorKind::usage,
                    source +
                        ": unknown source; expected a file or folder, davis:, dvxplorer:, dvs128:, "
                        "v4l2:/dev/videoN, ros2:/TOPIC, udp://HOST:PORT, sim:SCENE, or - for "
                        "standard input" +
                        meant);
    if (!meant.empty()) throw Error(ErrorKind::input, "'" + source + "': no such file" + meant);
}

/// Of what has a pace of its own.
void refuse_speed(const RunSettings& settings) {
    if (settings.speed == "auto") return;
    if (!names_simulation(settings.source) && !names_camera(settings.source)) return;
    throw Error(
        ErrorKind::usage,
        "--speed " + settings.speed + ": expected a recording as SOURCE, found " + settings.source +
            (names_simulation(settings.source) ? "; a simulation's own is ?speed=S after its scene"
                                               : "; a camera has one speed"));
}

/// A setting that changes nothing is a misunderstanding.
void refuse_without_effect(const RunSettings& settings) {
    const std::string& source = settings.source;
    const bool is_simulated = names_simulation(source);
    const std::string meant = is_simulated ? "" : source_suggestion(source);
    const auto refuse = [&](const std::string& option, const char* expected,
                            const std::string& hint = {}) {
        throw Error(ErrorKind::usage,
                    option + ": expected a " + expected + " as SOURCE, found " + source + hint);
    };
    const bool is_camera = names_camera(source);
    if (!settings.camera.empty() && !is_camera)
        refuse("--camera " + settings.camera, "camera", meant);
    if (settings.reconnect && !is_camera) refuse("--reconnect", "camera", meant);
    if (!is_camera && !is_simulated) return;
    if (settings.input.size) refuse("--input-size " + show_size(*settings.input.size), "recording");
    if (!settings.input.open.format.empty())
        refuse("--input-format " + settings.input.open.format, "recording");
    if (!settings.input.open.stream.empty())
        refuse("--input-stream " + settings.input.open.stream, "recording");
}

OpenedSource open_file(const RunSettings& settings, double speed,
                       const std::function<bool()>& give_up) {
    refuse_unknown_source(settings.source);
    auto recording = open_input(settings.source, settings.input, give_up);
    OpenedSource opened;
    if (speed > 0) {
        auto paced = std::make_unique<RealTimePlayback>(std::move(recording), speed);
        opened.recording = opened.paced = paced.get();
        opened.source = std::move(paced);
    } else {
        opened.recording = recording.get();
        opened.source = std::move(recording);
    }
    return opened;
}

void check_size(const Source& source, const std::string& name) {
    const int width = source.info().width, height = source.info().height;
    if (width < 1 || height < 1)
        throw Error(ErrorKind::usage, name +
                                          ": the recording does not say the sensor's size; "
                                          "--input-size 240x180 tells it");
    // A header that lies must not make us ask for all the memory there is.
    if (width > kLargestSensorSide || height > kLargestSensorSide)
        throw Error(ErrorKind::input,
                    name + ": expected a sensor of at most " + std::to_string(kLargestSensorSide) +
                        " px each way, found " + std::to_string(width) + "x" +
                        std::to_string(height) + "; --input-size states another size");
}

}  // namespace

OpenedSource open_source(const RunSettings& settings, double speed,
                         const std::function<bool()>& give_up) {
    OpenedSource opened;
    const auto warn = [](const std::string& text) { spdlog::warn("{}", printable(text)); };
    refuse_without_effect(settings);
    refuse_speed(settings);
    if (names_simulation(settings.source))
        opened.source = open_simulation(settings.source);
    else if (names_camera(settings.source))
        opened.source =
            open_camera(settings.source, {settings.camera, settings.reconnect, give_up, warn});
    else
        opened = open_file(settings, speed, give_up);
    check_size(*opened.source, settings.source);
    return opened;
}

}  // namespace eventide::app
