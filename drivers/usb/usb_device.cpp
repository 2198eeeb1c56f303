#include "drivers/usb/usb_device.h"

#include "src/core/error.h"
#include "src/io/system_words.h"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

namespace eventide {
namespace {

constexpr std::uint8_t kRegisterRequest = 0xBF, kManyRegistersRequest = 0xC2;
constexpr std::uint8_t kOut = 0x40, kIn = 0xC0;  // vendor request, to the device
constexpr unsigned kControlTimeoutMs = 1000;
constexpr int kInterface = 0, kConfiguration = 1;
constexpr std::size_t kSerialLength = 8;
constexpr int kDescriptors = 8;  // that libusb opens, about

using Context = std::unique_ptr<libusb_context, FreeUsbContext>;
using Handle = std::unique_ptr<libusb_device_handle, CloseUsbDevice>;

struct FreeDeviceList {
    void operator()(libusb_device** list) const { libusb_free_device_list(list, 1); }
};
using DeviceList = std::unique_ptr<libusb_device*, FreeDeviceList>;

Context make_context() {
    libusb_context* context = nullptr;
    if (const int code = libusb_init(&context); code != 0)
        throw Error(ErrorKind::device, "USB: libusb cannot start: " + explain_usb_error(code));
    return Context{context};
}

std::string port_of(libusb_device* device) {
    constexpr int kDeepest = 7;
    std::array<std::uint8_t, kDeepest> ports{};
    const int depth = libusb_get_port_numbers(device, ports.data(), kDeepest);
    std::string text = std::to_string(libusb_get_bus_number(device));
    for (int i = 0; i < depth; ++i)
        text += (i == 0 ? "-" : ".") + std::to_string(ports[std::size_t(i)]);
    return text;
}

UsbIdentity identity_of(libusb_device* device, const libusb_device_descriptor& descriptor) {
    UsbIdentity identity;
    identity.vendor = descriptor.idVendor;
    identity.product = descriptor.idProduct;
    identity.firmware = std::uint8_t(descriptor.bcdDevice & 0xFF);
    identity.board_type = std::uint8_t(descriptor.bcdDevice >> 8);
    identity.superspeed = libusb_get_device_speed(device) >= LIBUSB_SPEED_SUPER;
    identity.bus = libusb_get_bus_number(device);
    identity.address = libusb_get_device_address(device);
    identity.port = port_of(device);
    return identity;
}

/// Empty where it has none.
std::string read_serial(libusb_device_handle* handle, const libusb_device_descriptor& descriptor) {
    std::array<unsigned char, 64> text{};
    const int length = descriptor.iSerialNumber == 0
                           ? 0
                           : libusb_get_string_descriptor_ascii(handle, descriptor.iSerialNumber,
                                                                text.data(), int(text.size()));
    std::string serial(text.begin(), text.begin() + std::max(0, length));
    if (serial.size() > kSerialLength) serial.resize(kSerialLength);
    return serial;
}

/// Cameras without a serial number are told apart by where they are plugged in, as libcaer does.
std::string made_up_serial(const UsbIdentity& identity) {
    std::array<char, 16> made_up{};
    std::snprintf(made_up.data(), made_up.size(), "TMP%05d",
                  ((identity.bus << 8) | identity.address) % 100000);
    return made_up.data();
}

struct Found {
    UsbIdentity identity;
    Handle handle;  // empty where it could not be opened
};

/// Calls visit(found) for every device that fits, until it returns true.
template <typename Visit>
void for_each_device(libusb_context* context, const UsbSelector& selector, Visit visit) {
    libusb_device** raw = nullptr;
    const auto count = libusb_get_device_list(context, &raw);
    if (count < 0)
        throw Error(ErrorKind::device, "USB: no list of devices: " + explain_usb_error(int(count)));
    const DeviceList list{raw};
    for (auto device : std::span(raw, std::size_t(count))) {
        libusb_device_descriptor descriptor{};
        if (libusb_get_device_descriptor(device, &descriptor) != 0) continue;
        if (descriptor.idVendor != selector.vendor ||
            std::find(selector.products.begin(), selector.products.end(), descriptor.idProduct) ==
                selector.products.end())
            continue;
        Found found{identity_of(device, descriptor), nullptr};
        if (selector.bus >= 0 && found.identity.bus != selector.bus) continue;
        if (selector.address >= 0 && found.identity.address != selector.address) continue;
        if (!selector.port.empty() && found.identity.port != selector.port) continue;
        libusb_device_handle* opened = nullptr;
        if (const int code = libusb_open(device, &opened); code != 0) {
            found.identity.problem = explain_usb_error(code);
        } else {
            found.handle.reset(opened);
            found.identity.serial = read_serial(opened, descriptor);
            found.identity.has_serial = !found.identity.serial.empty();
            if (!found.identity.has_serial) found.identity.serial = made_up_serial(found.identity);
        }
        if (found.handle && !selector.serial.empty() && found.identity.serial != selector.serial)
            continue;
        if (visit(std::move(found))) return;
    }
}

std::string describe(const UsbSelector& selector) {
    std::string text = selector.name;
    if (!selector.serial.empty()) text += " with serial '" + selector.serial + "'";
    if (!selector.port.empty()) text += " at port " + selector.port;
    if (selector.bus >= 0) text += " on bus " + std::to_string(selector.bus);
    if (selector.address >= 0) text += " at address " + std::to_string(selector.address);
    return text;
}

/// The second byte order in the protocol: control values are big-endian, data words little-endian.
std::array<unsigned char, 4> big_endian(std::uint32_t value) {
    return {static_cast<unsigned char>(value >> 24), static_cast<unsigned char>(value >> 16),
            static_cast<unsigned char>(value >> 8), static_cast<unsigned char>(value)};
}

}  // namespace

void FreeUsbContext::operator()(libusb_context* context) const {
    libusb_exit(context);
}
void CloseUsbDevice::operator()(libusb_device_handle* handle) const {
    libusb_close(handle);
}

std::string explain_usb_error(int code) {
    if ((code == LIBUSB_ERROR_OTHER || code == LIBUSB_ERROR_IO) && out_of_descriptors(kDescriptors))
        return system_words(EMFILE);
    switch (code) {
        case LIBUSB_ERROR_ACCESS:
            return "no permission: install 65-eventide.rules (of config/udev, or lib/udev/rules.d) "
                   "into /etc/udev/rules.d, run 'udevadm control --reload', and plug the camera in "
                   "again";
        case LIBUSB_ERROR_BUSY:
            return "in use by another program: close it (DV, jAER, another eventide) and try again";
        case LIBUSB_ERROR_NO_DEVICE:
            return "the camera was unplugged";
        case LIBUSB_ERROR_IO:
            return "the connection broke off: was the camera unplugged?";
        case LIBUSB_ERROR_TIMEOUT:
            return "the camera did not answer in time: plug it in again";
        case LIBUSB_ERROR_PIPE:
            return "the camera refused the request";
        case LIBUSB_ERROR_NOT_FOUND:
            return "not found";
        default:
            return libusb_strerror(code);
    }
}

void check_usb(int code, const std::string& what) {
    if (code >= 0) return;
    const std::string message = "USB: " + what + ": " + explain_usb_error(code);
    if (code == LIBUSB_ERROR_NO_DEVICE || code == LIBUSB_ERROR_IO) throw UsbDisconnected(message);
    throw Error(ErrorKind::device, message);
}

std::vector<UsbIdentity> list_usb_devices(const UsbSelector& selector) {
    const Context context = make_context();
    std::vector<UsbIdentity> all;
    for_each_device(context.get(), selector, [&](Found found) {
        all.push_back(std::move(found.identity));
        return false;
    });
    return all;
}

UsbDevice::UsbDevice(const UsbSelector& selector) : context_(make_context()) {
    std::string problem;
    for_each_device(context_.get(), selector, [&](Found found) {
        if (!found.handle) problem = found.identity.problem;
        identity_ = std::move(found.identity);
        handle_ = std::move(found.handle);
        return handle_ != nullptr;
    });
    if (!handle_) {
        throw Error(ErrorKind::device,
                    problem.empty()
                        ? "no " + describe(selector) + " found; run eventide devices"
                        : "the " + describe(selector) + " cannot be opened: " + problem);
    }
    int configuration = 0;
    check_usb(libusb_get_configuration(handle_.get(), &configuration),
              "the camera does not tell its configuration");
    if (configuration != kConfiguration)
        check_usb(libusb_set_configuration(handle_.get(), kConfiguration),
                  "the camera cannot be configured");
    check_usb(libusb_claim_interface(handle_.get(), kInterface), "the camera cannot be claimed");
}

UsbDevice::~UsbDevice() {
    libusb_release_interface(handle_.get(), kInterface);
}

std::uint32_t UsbDevice::read_register(davis::Register at) {
    std::array<unsigned char, 4> bytes{};
    const int got =
        libusb_control_transfer(handle_.get(), kIn, kRegisterRequest, at.module, at.address,
                                bytes.data(), std::uint16_t(bytes.size()), kControlTimeoutMs);
    const std::string name =
        "register " + std::to_string(at.module) + "." + std::to_string(at.address);
    check_usb(got, "reading " + name);
    if (got != int(bytes.size()))
        throw Error(ErrorKind::device,
                    "USB: reading " + name + ": expected 4 bytes, found " + std::to_string(got));
    return (std::uint32_t(bytes[0]) << 24) | (std::uint32_t(bytes[1]) << 16) |
           (std::uint32_t(bytes[2]) << 8) | bytes[3];
}

void UsbDevice::write_register(davis::Write write) {
    auto bytes = big_endian(write.value);
    const int sent = libusb_control_transfer(handle_.get(), kOut, kRegisterRequest, write.at.module,
                                             write.at.address, bytes.data(),
                                             std::uint16_t(bytes.size()), kControlTimeoutMs);
    check_usb(sent, "writing register " + std::to_string(write.at.module) + "." +
                        std::to_string(write.at.address));
}

void UsbDevice::write_registers(std::span<const davis::Write> writes) {
    for (const davis::Write& write : writes) write_register(write);
}

void UsbDevice::write_together(std::span<const davis::Write> writes) {
    std::vector<unsigned char> bytes;
    for (const davis::Write& write : writes) {
        bytes.push_back(static_cast<unsigned char>(write.at.module));
        bytes.push_back(static_cast<unsigned char>(write.at.address));
        const auto value = big_endian(write.value);
        bytes.insert(bytes.end(), value.begin(), value.end());
    }
    check_usb(libusb_control_transfer(handle_.get(), kOut, kManyRegistersRequest,
                                      std::uint16_t(writes.size()), 0, bytes.data(),
                                      std::uint16_t(bytes.size()), kControlTimeoutMs),
              "writing several registers");
}

std::uint64_t UsbDevice::read_counter(davis::Register at) {
    const davis::Register lower{at.module, std::uint16_t(at.address + 1)};
    for (;;) {
        const std::uint64_t before = read_register(at), low = read_register(lower),
                            after = read_register(at);
        if (before == after) return (before << 32) | low;
    }
}

void UsbDevice::vendor_out(std::uint8_t request, std::uint16_t value, std::uint16_t index,
                           std::span<const std::byte> data) {
    std::vector<unsigned char> bytes(data.size());
    std::transform(data.begin(), data.end(), bytes.begin(),
                   [](std::byte b) { return static_cast<unsigned char>(b); });
    check_usb(libusb_control_transfer(handle_.get(), kOut, request, value, index, bytes.data(),
                                      std::uint16_t(bytes.size()), kControlTimeoutMs),
              "a vendor request");
}

void UsbDevice::clear_halt(std::uint8_t endpoint) {
    check_usb(libusb_clear_halt(handle_.get(), endpoint), "clearing the data endpoint");
}

}  // namespace eventide
