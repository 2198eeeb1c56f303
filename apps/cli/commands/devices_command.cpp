// eventide devices: which cameras there are, and why one cannot be used.
#include "apps/cli/commands/devices_command.h"

#include "apps/cli/printable.h"
#include "drivers/devices.h"

#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include <iostream>

namespace eventide::app {

namespace {

nlohmann::ordered_json json_of(const CameraDescription& camera) {
    return {{"source", camera.source},   {"name", camera.name},
            {"serial", camera.serial},   {"bus", camera.bus},
            {"address", camera.address}, {"firmware", camera.firmware},
            {"logic", camera.logic},     {"usable", camera.problem.empty()},
            {"problem", camera.problem}};
}

void print(const CameraDescription& camera) {
    std::string line = camera.source + "  " + camera.name;
    if (!camera.serial.empty()) line += ", serial " + camera.serial;
    if (!camera.firmware.empty()) line += ", firmware " + camera.firmware;
    if (!camera.logic.empty()) line += ", FPGA logic version " + camera.logic;
    std::cout << printable(line) << '\n';
    if (!camera.problem.empty())
        std::cout << "    cannot be used: " << printable(camera.problem) << '\n';
}

}  // namespace

SettingTable DevicesCommand::settings() {
    SettingTable table{"devices", "eventide devices: cameras found.", {}};
    table.settings.push_back(flag_setting("json", json_, "A JSON list instead of lines."));
    return table;
}

int DevicesCommand::run(Program&) {
    const auto cameras = list_cameras();
    if (json_) {
        auto list = nlohmann::ordered_json::array();
        for (const CameraDescription& camera : cameras) list.push_back(json_of(camera));
        std::cout << json_text(list) << '\n';
        return exit_done;
    }
    for (const CameraDescription& camera : cameras) print(camera);
    if (cameras.empty()) spdlog::info("no camera was found");
    return exit_done;
}

}  // namespace eventide::app
