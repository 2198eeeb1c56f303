// The descriptors of a USB camera, and the record by which umockdev makes its sysfs entries.
#pragma once

#include "tests/support/usb/usb_model.h"

#include <cstdint>
#include <string>
#include <vector>

namespace eventide::testing_support {

/// Where on bus 1 a device is.
struct UsbPlace {
    int port = 0;  ///< 0: none, as the bus's own hub
    int address = 1;
};
std::string sysfs_path(const UsbPlace& place);  ///< below /sys
std::string device_node(const UsbPlace& place);

/// umockdev's description of the device there.
std::string device_record(const UsbModelIdentity& identity, const UsbPlace& place);

/// String descriptors by index: 0 languages, 3 the serial number.
std::vector<std::uint8_t> string_descriptor(const UsbModelIdentity& identity, std::uint8_t index);

}  // namespace eventide::testing_support
