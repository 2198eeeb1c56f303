// The descriptors of a USB camera, and the record by which umockdev makes its sysfs entries.
#pragma once

#include "tests/support/usb/usb_model.h"

#include <cstdint>
#include <string>
#include <vector>

namespace eventide::testing_support {

/// umockdev's description of the device at bus 1, address 1.
std::string device_record(const UsbModelIdentity& identity);

/// String descriptors by index: 0 languages, 3 the serial number.
std::vector<std::uint8_t> string_descriptor(const UsbModelIdentity& identity, std::uint8_t index);

}  // namespace eventide::testing_support
