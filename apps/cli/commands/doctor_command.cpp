// eventide doctor: each thing looked at in the way the program itself uses it.
#include "apps/cli/commands/doctor_command.h"

#include "apps/cli/printable.h"
#include "apps/cli/run/loaded_model.h"
#include "apps/cli/version.h"
#include "drivers/devices.h"
#include "pipeline/ros2/ros2_sink.h"
#include "pipeline/sinks/http/listening_socket.h"
#include "pipeline/sinks/video/video.h"
#include "pipeline/sinks/window.h"
#include "src/core/error.h"

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <iostream>
#include <string>
#include <vector>

namespace eventide::app {

namespace {

struct Finding {
    enum class State {
        good,
        absent,  ///< not there, and not needed by all
        bad      ///< there and not usable, or needed and not there
    };
    std::string subject;
    State state = State::good;
    std::string found, advice;
};
using State = Finding::State;

std::string name_of(State state) {
    switch (state) {
        case State::good:
            return "ok";
        case State::absent:
            return "absent";
        case State::bad:
            return "bad";
    }
    return {};
}

Finding processor() {
    const std::string found = processor_text();
    if (found.find("avx2") != found.npos) return {"processor", State::good, found, ""};
    return {"processor", State::absent, found,
            "without AVX2 the network runs on slower, portable kernels"};
}

/// The default model as run would use it, for a small sensor.
Finding network() {
    try {
        const Network made{RunSettings{}, {"", "", "", 64, 48}};
        return {"network", State::good, made.file().string() + "; " + made.encoder().description(),
                ""};
    } catch (const Error& error) {
        return {"network", State::bad, error.what(),
                "--model FILE or EVENTIDE_MODELS=FOLDER says where models are"};
    }
}

Finding video() {
    constexpr const char* kAdvice =
        "install Debian's libavcodec, or write frames (--out frames/) or Y4M (--out -)";
    try {
        if (encodes_h264()) return {"video", State::good, "libx264", ""};
        return {"video", State::bad, video_library() + " has no libx264", kAdvice};
    } catch (const Error& error) {
        return {"video", State::bad, error.what(), kAdvice};
    }
}

Finding window() {
    try {
        require_display();
        return {"window", State::good, "a display answers", ""};
    } catch (const Error& error) {
        return {"window", State::absent, error.what(), ""};
    }
}

/// The port that --out http: takes where none is named.
Finding page() {
    HttpAddress address;
    try {
        ::close(listen_at(address));
        return {"page", State::good, "nobody listens at " + url_of(address) + " yet", ""};
    } catch (const Error& error) {
        return {"page", State::absent, error.what(), ""};
    }
}

Finding ros2() {
    const Ros2State state = look_at_ros2();
    const bool good = state.works && state.advice.empty();
    return {"ROS 2",
            good                          ? State::good
            : state.built && !state.works ? State::bad
                                          : State::absent,
            state.found, state.advice};
}

std::vector<Finding> cameras() {
    std::vector<Finding> findings;
    for (const CameraDescription& camera : list_cameras()) {
        const bool usable = camera.problem.empty();
        findings.push_back({"camera " + camera.source, usable ? State::good : State::bad,
                            camera.name + (camera.serial.empty() ? "" : ", " + camera.serial),
                            camera.problem});
    }
    if (findings.empty())
        findings.push_back(
            {"camera", State::absent, "none found",
             "is it plugged in? For permissions see 65-eventide.rules (docs/cameras.md)"});
    return findings;
}

void print(const Finding& finding) {
    const std::string state = name_of(finding.state);
    std::cout << state << std::string(8 - state.size(), ' ')
              << printable(finding.subject + ": " + finding.found) << '\n';
    if (!finding.advice.empty()) std::cout << "        " << printable(finding.advice) << '\n';
}

}  // namespace

SettingTable DoctorCommand::settings() {
    SettingTable table{"doctor", "eventide doctor: check this machine and suggest fixes.", {}};
    table.settings.push_back(flag_setting("json", json_, "A JSON list instead of lines."));
    return table;
}

int DoctorCommand::run(Program&) {
    std::vector<Finding> findings{processor(), network(), video(), window(), page(), ros2()};
    for (Finding& camera : cameras()) findings.push_back(std::move(camera));
    auto list = nlohmann::ordered_json::array();
    bool bad = false;
    for (const Finding& finding : findings) {
        bad |= finding.state == State::bad;
        list.push_back({{"subject", finding.subject},
                        {"state", name_of(finding.state)},
                        {"found", finding.found},
                        {"advice", finding.advice}});
        if (!json_) print(finding);
    }
    if (json_) std::cout << json_text(list) << '\n';
    return bad ? int(ErrorKind::failed) : exit_done;
}

}  // namespace eventide::app
