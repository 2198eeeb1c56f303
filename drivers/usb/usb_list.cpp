// Which cameras of a kind are plugged in.
#include "drivers/usb/usb_camera.h"
#include "src/core/error.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

namespace eventide {

namespace {

/// Whether a serial number can be given on a command line as it is, and is not taken for a place.
bool is_word(const std::string& serial) {
    return !serial.empty() && std::ranges::all_of(serial, [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
    });
}

CameraDescription describe(const UsbKind& kind, const UsbIdentity& identity, bool is_only_one) {
    CameraDescription camera;
    camera.name = kind.name;
    camera.serial = identity.serial;
    camera.bus = identity.bus;
    camera.address = identity.address;
    camera.source =
        kind.scheme + (is_only_one && is_word(identity.serial)
                           ? identity.serial
                           : std::to_string(identity.bus) + ":" + std::to_string(identity.address));
    camera.firmware = std::to_string(identity.firmware);
    camera.problem = identity.problem;
    return camera;
}

}  // namespace

std::vector<CameraDescription> list_usb_cameras(
    const UsbKind& kind,
    const std::function<std::unique_ptr<UsbCamera>(const UsbCameraOptions&)>& open) {
    UsbSelector selector;
    selector.products = kind.products;
    std::vector<CameraDescription> cameras;
    const auto identities = list_usb_devices(selector);
    for (const UsbIdentity& identity : identities) {
        const auto alike = std::ranges::count(identities, identity.serial, &UsbIdentity::serial);
        CameraDescription camera = describe(kind, identity, alike == 1);
        if (camera.problem.empty()) {
            UsbCameraOptions options;
            options.bus = identity.bus;
            options.address = identity.address;
            try {
                const auto opened = open(options);
                camera.name = opened->info().name;
                camera.logic = opened->logic();
            } catch (const Error& error) {
                camera.problem = error.what();
            }
        }
        cameras.push_back(std::move(camera));
    }
    return cameras;
}

}  // namespace eventide
