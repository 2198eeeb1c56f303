// What the settings of several USB cameras have in common, and how their files say it.
#pragma once

#include "drivers/usb/usb_stream.h"
#include "src/settings/setting.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace eventide {

/// Part of a sensor, px, as a person sees the frame.
struct SensorRegion {
    int x = 0, y = 0, width = 0, height = 0;
};

/// Which events the camera sends. Flat: all, without saying which way the brightness went (a
/// DAVIS's read as OFF).
enum class SentPolarity : std::uint8_t { both, on, off, flat };

/// Throws Error (usage) unless the region lies in a sensor of this size; `name` is the setting's.
void require_inside(const SensorRegion& region, const char* name, int width, int height);

// Of read_camera_settings().
Setting region_setting(const char* key, std::optional<SensorRegion>& into);
Setting polarity_setting(SentPolarity& into);
Setting transfers_setting(UsbStreamSettings& into);
Setting transfer_size_setting(UsbStreamSettings& into);
/// A table of names and whole numbers up to `most`.
Setting biases_setting(std::map<std::string, std::uint32_t>& into, std::uint32_t most);

}  // namespace eventide
