#include "drivers/devices.h"

#include "src/core/error.h"

#ifdef EVENTIDE_HAS_USB
#include "drivers/usb/davis_camera.h"
#endif
#ifdef EVENTIDE_HAS_V4L2
#include "drivers/v4l2/v4l2_camera.h"
#endif

#include <charconv>

namespace eventide {
namespace {

constexpr std::string_view kDavis = "davis:", kV4l2 = "v4l2:";

#ifdef EVENTIDE_HAS_USB
bool number(std::string_view text, int& into) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), into);
    return error == std::errc{} && end == text.data() + text.size() && into >= 0;
}

std::unique_ptr<Camera> open_davis(std::string_view which, const CameraOptions& options) {
    DavisOptions davis;
    davis.reconnect = options.reconnect;
    if (!options.settings.empty()) davis.settings = load_davis_settings(options.settings);
    const auto colon = which.find(':');
    if (colon == which.npos) {
        davis.serial = std::string{which};
    } else if (!number(which.substr(0, colon), davis.bus) ||
               !number(which.substr(colon + 1), davis.address)) {
        throw Error(ErrorKind::usage, "source 'davis:" + std::string{which} +
                                          "': expected davis:, davis:SERIAL or davis:BUS:ADDRESS");
    }
    return std::make_unique<DavisCamera>(std::move(davis));
}
#endif

[[maybe_unused]] [[noreturn]] void not_built(std::string_view source, const char* option) {
    throw Error(ErrorKind::usage,
                "source '" + std::string{source} + "': this eventide was built without " + option);
}

}  // namespace

bool names_camera(std::string_view source) {
    return source.starts_with(kDavis) || source.starts_with(kV4l2);
}

std::unique_ptr<Camera> open_camera(std::string_view source, const CameraOptions& options) {
    if (source.starts_with(kDavis)) {
#ifdef EVENTIDE_HAS_USB
        return open_davis(source.substr(kDavis.size()), options);
#else
        not_built(source, "EVENTIDE_USB");
#endif
    }
    if (source.starts_with(kV4l2)) {
#ifdef EVENTIDE_HAS_V4L2
        return open_v4l2(source.substr(kV4l2.size()), options);
#else
        not_built(source, "EVENTIDE_V4L2");
#endif
    }
    throw Error(ErrorKind::usage,
                "source '" + std::string{source} + "' names no camera: expected davis: or v4l2:");
}

std::vector<CameraDescription> list_cameras() {
    std::vector<CameraDescription> all;
#ifdef EVENTIDE_HAS_USB
    all = list_davis_cameras();
#endif
#ifdef EVENTIDE_HAS_V4L2
    for (auto& camera : list_v4l2_cameras()) all.push_back(std::move(camera));
#endif
    return all;
}

}  // namespace eventide
