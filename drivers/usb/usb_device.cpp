#include "drivers/usb/usb_device.h"

#include "src/core/error.h"
#include "src/io/system_words.h"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace eventide {
namespace {

constexpr std::uint8_t kRegisterRequest = 0xBF, kManyRegistersRequest = 0xC2;
constexpr std::uint8_t kOut = 0x40, kIn = 0xC0;  // vendor request, to the device
constexpr unsigned kControlTimeoutMs = 1000;
constexpr int kInterface = 0, kConfiguration = 1;
constexpr int kDescriptors = 8;  // that libusb opens, about

/// The second byte order in the protocol: control values are big-endian, data words little-endian.
std::array<unsigned char, 4> big_endian(std::uint32_t value) {
    return {static_cast<unsigned char>(value >> 24), static_cast<unsigned char>(value >> 16),
            static_cast<unsigned char>(value >> 8), static_cast<unsigned char>(value)};
}

/// "0.83"
std::string number_of(davis::Register at) {
    return std::to_string(at.module) + "." + std::to_string(at.address);
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

UsbDevice::UsbDevice(UsbIdentity identity, Handle handle, const std::string& label)
    : identity_(std::move(identity)), handle_(std::move(handle)) {
    int configuration = 0;
    check_usb(libusb_get_configuration(handle_.get(), &configuration),
              label + " does not tell its configuration");
    if (configuration != kConfiguration)
        check_usb(libusb_set_configuration(handle_.get(), kConfiguration),
                  label + " cannot be configured");
    check_usb(libusb_claim_interface(handle_.get(), kInterface), label + " cannot be claimed");
}

UsbDevice::~UsbDevice() {
    libusb_release_interface(handle_.get(), kInterface);
}

std::uint32_t UsbDevice::read_register(davis::Register at) {
    std::array<unsigned char, 4> bytes{};
    const int got =
        libusb_control_transfer(handle_.get(), kIn, kRegisterRequest, at.module, at.address,
                                bytes.data(), std::uint16_t(bytes.size()), kControlTimeoutMs);
    const std::string name = "register " + number_of(at);
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
    check_usb(sent, "writing register " + number_of(write.at));
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
    constexpr int kTries = 5;
    const davis::Register lower{at.module, std::uint16_t(at.address + 1)};
    for (int i = 0; i < kTries; ++i) {
        const std::uint64_t before = read_register(at), low = read_register(lower),
                            after = read_register(at);
        if (before == after) return (before << 32) | low;
    }
    throw Error(ErrorKind::device,
                "USB: reading counter " + number_of(at) + ": its upper half is another each time");
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
