// What the settings of several USB cameras have in common, and how their files say it.
#pragma once

#include "drivers/usb/usb_stream.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace eventide {

class SettingsFile;

/// Part of a sensor, px, as a person sees the frame.
struct SensorRegion {
    int x = 0, y = 0, width = 0, height = 0;
};

/// Which events the camera sends. Flat: all, without saying which way the brightness went (they
/// read as ON).
enum class SentPolarity : std::uint8_t { both, on, off, flat };

/// Throws Error (usage) unless the region lies in a sensor of this size; `name` is the setting's.
void require_inside(const SensorRegion& region, const char* name, int width, int height);

// Keys for a SettingsFile.
void add_region(SettingsFile& file, const char* name, std::optional<SensorRegion>& into);
void add_polarity(SettingsFile& file, const char* name, SentPolarity& into);
void add_transfers(SettingsFile& file, UsbStreamSettings& into);
/// A table of names and whole numbers up to `most`.
void add_biases(SettingsFile& file, std::map<std::string, std::uint32_t>& into, std::uint32_t most);

}  // namespace eventide
