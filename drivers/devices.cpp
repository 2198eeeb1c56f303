#include "drivers/devices.h"

#include "drivers/simulated/simulated_name.h"
#include "drivers/udp/udp_source.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/settings/suggestion.h"

#ifdef EVENTIDE_HAS_USB
#include "drivers/usb/davis_camera.h"
#include "drivers/usb/dvs128_camera.h"
#include "drivers/usb/dvxplorer_camera.h"
#endif
#ifdef EVENTIDE_HAS_V4L2
#include "drivers/v4l2/v4l2_camera.h"
#endif

#ifdef EVENTIDE_HAS_ROS2
#include "drivers/ros2/ros2_source.h"
#endif

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

namespace eventide {
namespace {

/// A kind of camera: what its sources begin with, and how one is opened. `open` is empty where the
/// driver was not built.
struct Kind {
    std::string_view scheme;
    const char* build_option;
    std::unique_ptr<Camera> (*open)(std::string_view which, const CameraOptions& options);
    std::vector<CameraDescription> (*list)();
};

#ifdef EVENTIDE_HAS_USB
bool number(std::string_view text, int& into) {
    into = number_in<int>(text).value_or(-1);
    return into >= 0;
}

/// What follows the scheme: nothing, a serial number, or bus and address.
template <typename OpenedCamera, typename Options, auto load_settings>
std::unique_ptr<Camera> open_usb(std::string_view which, const CameraOptions& asked) {
    Options options;
    options.reconnect = asked.reconnect;
    options.warn = asked.warn;
    if (!asked.settings.empty()) options.settings = load_settings(asked.settings);
    const auto colon = which.find(':');
    if (colon == which.npos)
        options.serial = std::string{which};
    else if (!number(which.substr(0, colon), options.bus) ||
             !number(which.substr(colon + 1), options.address))
        throw Error(ErrorKind::usage, "camera '" + std::string{which} +
                                          "': expected nothing, SERIAL or BUS:ADDRESS (lsusb)");
    return std::make_unique<OpenedCamera>(std::move(options));
}

// NOLINTBEGIN(readability-identifier-naming): functions, by other names.
constexpr auto open_davis = open_usb<DavisCamera, DavisOptions, load_davis_settings>;
constexpr auto open_dvxplorer =
    open_usb<DvxplorerCamera, DvxplorerOptions, load_dvxplorer_settings>;
constexpr auto open_dvs128 = open_usb<Dvs128Camera, Dvs128Options, load_dvs128_settings>;
// NOLINTEND(readability-identifier-naming)
#else
constexpr std::nullptr_t open_davis = nullptr, open_dvxplorer = nullptr, open_dvs128 = nullptr;
constexpr std::nullptr_t list_davis_cameras = nullptr, list_dvxplorer_cameras = nullptr,
                         list_dvs128_cameras = nullptr;
#endif
#ifndef EVENTIDE_HAS_V4L2
constexpr std::nullptr_t open_v4l2 = nullptr, list_v4l2_cameras = nullptr;
#endif

std::vector<CameraDescription> list_no_senders() {
    return {};  // who sends is known only when it does
}

#ifdef EVENTIDE_HAS_ROS2
std::vector<CameraDescription> list_no_topics() {
    return {};  // who publishes is known only after seconds of listening: ros2 topic list
}
#else
constexpr std::nullptr_t open_ros2_source = nullptr, list_no_topics = nullptr;
#endif

constexpr std::array<Kind, 6> kKinds{
    {{"davis:", "EVENTIDE_USB", open_davis, list_davis_cameras},
     {"dvxplorer:", "EVENTIDE_USB", open_dvxplorer, list_dvxplorer_cameras},
     {"dvs128:", "EVENTIDE_USB", open_dvs128, list_dvs128_cameras},
     {"v4l2:", "EVENTIDE_V4L2", open_v4l2, list_v4l2_cameras},
     {"ros2:", "EVENTIDE_ROS2 (cyclonedds-dev)", open_ros2_source, list_no_topics},
     {"udp:", "", open_udp_source, list_no_senders}}};

const Kind* kind_of(std::string_view source) {
    const auto found = std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& kind) {
        return source.starts_with(kind.scheme);
    });
    return found == kKinds.end() ? nullptr : &*found;
}

}  // namespace

bool names_camera(std::string_view source) {
    return kind_of(source) != nullptr;
}

bool names_device_alone(const std::string& source) {
    std::error_code none;
    return (names_camera(source) || names_simulation(source)) &&
           !std::filesystem::exists(source, none);
}

std::string source_suggestion(std::string_view source) {
    std::vector<std::string> schemes{std::string{kSimulatedScheme}};
    for (const Kind& kind : kKinds) schemes.emplace_back(kind.scheme);
    const std::string scheme{source.substr(0, source.find(':'))};
    return scheme.empty() || scheme.find('/') != scheme.npos ? ""
                                                             : suggestion(scheme + ":", schemes);
}

std::unique_ptr<Camera> open_camera(std::string_view source, const CameraOptions& options) {
    const Kind* kind = kind_of(source);
    if (kind == nullptr)
        throw Error(ErrorKind::usage, "source '" + std::string{source} +
                                          "' names no camera: expected davis:, dvxplorer:, "
                                          "dvs128:, v4l2:, ros2:, udp: or sim:" +
                                          source_suggestion(source));
    if (kind->open == nullptr)
        throw Error(ErrorKind::usage, "source '" + std::string{source} +
                                          "': this eventide was built without " +
                                          kind->build_option);
    return kind->open(source.substr(kind->scheme.size()), options);
}

std::vector<CameraDescription> list_cameras() {
    std::vector<CameraDescription> all;
    for (const Kind& kind : kKinds)
        if (kind.list != nullptr)
            for (auto& camera : kind.list()) all.push_back(std::move(camera));
    return all;
}

}  // namespace eventide
