// Which camera is taken for the one that was unplugged, and the wait until it is back.
#include "drivers/usb/usb_camera.h"
#include "src/core/error.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <thread>

namespace eventide {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{20};

/// "DAVIS346B of 346x260 px"
std::string model_text(const SensorInfo& info) {
    return info.name + " of " + std::to_string(info.width) + "x" + std::to_string(info.height) +
           " px";
}

}  // namespace

/// Of a camera without a serial number only the port is known.
void UsbCamera::require_same(const SensorInfo& found, bool same_words) const {
    if (info_.width == 0) return;
    const std::string was = "is a " + model_text(info_) + ", found ";
    if (found.name != info_.name || found.width != info_.width || found.height != info_.height)
        refuse(was + "a " + model_text(found) + " in its place");
    if (!same_words)
        refuse(was + "one with another orientation, colour filter or IMU in its place");
}

/// The same camera must come back, not another; one without a serial number of its own to the same
/// port.
void UsbCamera::expect_return_of(const UsbIdentity& identity) {
    selector_.bus = selector_.address = -1;
    if (!options_.reconnect) return;
    selector_.serial = identity.has_serial ? identity.serial : "";
    if (identity.has_serial)
        look_for_namesakes(identity);
    else
        selector_.port = identity.port;
}

/// Where another says the same serial number, the port tells them apart from then on.
void UsbCamera::look_for_namesakes(const UsbIdentity& identity) {
    if (!selector_.port.empty()) return;
    const auto all = list_usb_devices(selector_);
    const auto others = std::ranges::count_if(all, [&](const UsbIdentity& other) {
        return other.serial == identity.serial && other.port != identity.port;
    });
    if (others == 0) return;
    selector_.port = identity.port;
    if (options_.warn)
        options_.warn(std::to_string(others + 1) + " " + kind_.name +
                      " say that their serial number is '" + identity.serial +
                      "': if this one is unplugged, it is taken back at its port alone");
}

/// Closes the camera, and looks for others once it is closed: so soon nobody can have plugged it in
/// elsewhere.
void UsbCamera::leave(const std::function<void()>& how) {
    std::optional<UsbIdentity> identity;
    if (options_.reconnect && device_) identity = device_->identity();
    how();
    if (!identity) return;
    try {
        look_for_namesakes(*identity);
    } catch (const Error&) {
        // Its serial number has to do.
    }
}

/// The camera is gone. Without reconnect that ends the run; with it, silence until it is back.
ReadStatus UsbCamera::lost() {
    leave([this] { close(); });
    if (!options_.reconnect) refuse(std::string{"was unplugged"} + kReconnect);
    return ReadStatus::timeout;
}

ReadStatus UsbCamera::wait_for_return() {
    if (!options_.reconnect) return lost();
    try {
        open();
        start();
        if (stopped_) return ReadStatus::timeout;  // before it began
        count(CameraCount::reconnects);
        gap_ = reopened_ = true;
        warnings_.is_back();
    } catch (const Error& error) {  // not there yet, or not yet ready: the next look will tell
        drops_are_told_ = false;    // of a stream that did not begin
        stop_device();
        warnings_.tell(error);
        std::this_thread::sleep_for(kBetweenLooks);
    }
    return ReadStatus::timeout;
}

}  // namespace eventide
