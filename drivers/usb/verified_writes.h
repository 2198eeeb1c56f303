// Settings that are read back after they were written.
#pragma once

#include "drivers/usb/davis_registers.h"

#include <span>

namespace eventide {

class UsbDevice;

/// Writes all; with `verify` reads each register back and compares. Throws Error (device) that
/// names the register, what was written and what it says. Registers that do something instead of
/// holding a value (timestamp reset, restart of the readout) are not read back.
void write_settings(UsbDevice& device, std::span<const davis::Write> writes, bool verify);

}  // namespace eventide
