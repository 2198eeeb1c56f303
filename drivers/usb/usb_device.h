// One USB device, opened: control requests and bulk streaming through libusb. The only folder that
// knows libusb.
#pragma once

#include "drivers/usb/davis_registers.h"
#include "src/core/error.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct libusb_context;
struct libusb_device;
struct libusb_device_handle;

namespace eventide {

struct UsbIdentity {
    std::uint16_t vendor = 0, product = 0;
    std::uint8_t firmware = 0;    ///< low byte of bcdDevice
    std::uint8_t board_type = 0;  ///< high byte of bcdDevice
    bool superspeed = false;      ///< on USB 3; else slower, as far as is known
    int bus = 0, address = 0;     ///< the address is another each time it is plugged in
    std::string port;             ///< "1-4.2": the bus and the ports on the way
    std::string serial;  ///< at most 8 characters; "TMP" and five digits where the device has none
    bool has_serial = false;
    std::string problem;  ///< why it could not be opened; empty where it could
};

/// Which device: all conditions that are set must hold.
struct UsbSelector {
    std::string name = "camera";    ///< in messages: "DAVIS"
    std::uint16_t vendor = 0x152A;  ///< iniVation
    std::vector<std::uint16_t> products;
    std::string serial, port;
    int bus = -1, address = -1;
};

struct FreeUsbContext {
    void operator()(libusb_context* context) const;
};
struct CloseUsbDevice {
    void operator()(libusb_device_handle* handle) const;
};

/// Devices on the bus that fit, opened for a moment to read their serial where permitted.
std::vector<UsbIdentity> list_usb_devices(const UsbSelector& selector);

class UsbDevice {
public:
    /// The first device that fits and can be used: opened, in configuration 1, interface 0 claimed,
    /// and `set_up` threw no Error of kind device. `warn` (may be empty) hears why others were
    /// passed over. Throws Error (device) where there is none, saying of each what keeps it from
    /// being used and what to do: no permission (udev rule), in use.
    static std::unique_ptr<UsbDevice> open(const UsbSelector& selector,
                                           const std::function<void(UsbDevice&)>& set_up,
                                           const std::function<void(const std::string&)>& warn);
    ~UsbDevice();
    UsbDevice(const UsbDevice&) = delete;
    UsbDevice& operator=(const UsbDevice&) = delete;

    const UsbIdentity& identity() const { return identity_; }
    libusb_context* context() { return context_.get(); }
    libusb_device_handle* handle() { return handle_.get(); }

    /// FPGA registers, request 0xBF. Throw Error (device) when the device does not answer.
    std::uint32_t read_register(davis::Register at);
    void write_register(davis::Write write);
    void write_registers(std::span<const davis::Write> writes);
    /// Several registers in one request (0xC2).
    void write_together(std::span<const davis::Write> writes);
    /// A 64-bit counter at two addresses: upper half first; read again until the upper half stood
    /// still. Throws Error (device) where it never does.
    std::uint64_t read_counter(davis::Register at);

    /// Any vendor request out.
    void vendor_out(std::uint8_t request, std::uint16_t value, std::uint16_t index,
                    std::span<const std::byte> data);
    void clear_halt(std::uint8_t endpoint);

private:
    using Handle = std::unique_ptr<libusb_device_handle, CloseUsbDevice>;
    UsbDevice(UsbIdentity identity, Handle handle, const std::string& label);

    std::unique_ptr<libusb_context, FreeUsbContext> context_;  ///< once it is the one to be used
    UsbIdentity identity_;
    Handle handle_;
};

/// The device is not there any more, or the connection to it broke off.
class UsbDisconnected : public Error {
public:
    explicit UsbDisconnected(const std::string& message) : Error(ErrorKind::device, message) {}
};

/// Text of a libusb error code with what a user can do about it.
std::string explain_usb_error(int code);

/// Throws for a negative code: UsbDisconnected where the device is gone, else Error (device).
void check_usb(int code, const std::string& what);

}  // namespace eventide
