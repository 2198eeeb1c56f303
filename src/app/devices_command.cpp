// eventide devices: which cameras there are, and why one cannot be used.
#include "src/app/devices_command.h"

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
    std::cout << camera.source << "  " << camera.name;
    if (!camera.serial.empty()) std::cout << ", serial " << camera.serial;
    if (!camera.firmware.empty()) std::cout << ", firmware " << camera.firmware;
    if (!camera.logic.empty()) std::cout << ", logic " << camera.logic;
    std::cout << '\n';
    if (!camera.problem.empty()) std::cout << "    cannot be used: " << camera.problem << '\n';
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
        std::cout << list.dump(2) << '\n';
        return exit_done;
    }
    for (const CameraDescription& camera : cameras) print(camera);
    if (cameras.empty()) spdlog::info("no camera was found");
    return exit_done;
}

}  // namespace eventide::app
