#include "drivers/usb/verified_writes.h"

#include "drivers/usb/dvxplorer_registers.h"
#include "drivers/usb/usb_device.h"
#include "src/core/error.h"

#include <array>
#include <cstdio>
#include <map>
#include <string>

namespace eventide {
namespace {

using davis::Register;

std::string name_of(Register at) {
    constexpr std::array<const char*, 10> kModules{"MUX",  "DVS",     "APS", "IMU", "EXTINPUT",
                                                   "CHIP", "SYSINFO", "7",   "8",   "USB"};
    std::array<char, 8> address{};
    std::snprintf(address.data(), address.size(), at.address < 0x100 ? "%u" : "0x%04X",
                  unsigned(at.address));
    return std::string{kModules.at(at.module)} + "." + address.data();
}

/// The rest is done at once and reads as nothing, or is latched by the chip until it is reset.
bool holds_a_value(Register at) {
    return at != davis::kTimestampReset && at != dvxplorer::kTimestampReset &&
           at != dvxplorer::kRestart && at != dvxplorer::kBiasTrim;
}

}  // namespace

void write_settings(UsbDevice& device, std::span<const davis::Write> writes, bool verify) {
    device.write_registers(writes);
    if (!verify) return;
    std::map<Register, std::uint32_t> written;  // the last write counts
    for (const davis::Write& write : writes)
        if (holds_a_value(write.at)) written[write.at] = write.value;
    for (const auto& [at, value] : written) {
        const std::uint32_t found = device.read_register(at);
        if (found == value) continue;
        throw Error(ErrorKind::device,
                    "the camera '" + device.identity().serial +
                        "' did not take a setting: register " + name_of(at) + " was set to " +
                        std::to_string(value) + " and says " + std::to_string(found) +
                        " (verify = false in the camera's settings goes on without looking)");
    }
}

}  // namespace eventide
