// Which devices are on the bus, and the first of them that can be used.
#include "drivers/usb/usb_device.h"
#include "src/core/error.h"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <utility>

namespace eventide {
namespace {

constexpr std::size_t kSerialLength = 8;

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

/// "the DAVIS '00000042'", or where it is while its serial number cannot be read.
std::string label_of(const UsbSelector& selector, const Found& found) {
    const UsbIdentity& identity = found.identity;
    return "the " + selector.name +
           (found.handle ? " '" + identity.serial + "'"
                         : " on bus " + std::to_string(identity.bus) + " at address " +
                               std::to_string(identity.address));
}

/// What keeps each device that was tried from being used.
class Refusals {
public:
    /// In its handler.
    void add(const Error& error) {
        texts_.emplace_back(error.what());
        newest_ = std::current_exception();
    }
    const std::vector<std::string>& texts() const { return texts_; }
    [[noreturn]] void rethrow(const UsbSelector& selector) const {
        if (texts_.empty())
            throw Error(ErrorKind::device,
                        "no " + describe(selector) + " found; run eventide devices");
        if (texts_.size() == 1) std::rethrow_exception(newest_);
        std::string all;
        for (const std::string& text : texts_) all += (all.empty() ? "" : "; ") + text;
        throw Error(ErrorKind::device, "none of the " + std::to_string(texts_.size()) + " " +
                                           selector.name + " found can be used: " + all);
    }

private:
    std::vector<std::string> texts_;
    std::exception_ptr newest_;
};

}  // namespace

std::vector<UsbIdentity> list_usb_devices(const UsbSelector& selector) {
    const Context context = make_context();
    std::vector<UsbIdentity> all;
    for_each_device(context.get(), selector, [&](Found found) {
        all.push_back(std::move(found.identity));
        return false;
    });
    return all;
}

std::unique_ptr<UsbDevice> UsbDevice::open(const UsbSelector& selector,
                                           const std::function<void(UsbDevice&)>& set_up,
                                           const std::function<void(const std::string&)>& warn) {
    Context context = make_context();
    std::unique_ptr<UsbDevice> opened;
    Refusals refusals;
    for_each_device(context.get(), selector, [&](Found found) {
        const std::string label = label_of(selector, found);
        try {
            if (!found.handle)
                throw Error(ErrorKind::device,
                            label + " cannot be opened: " + found.identity.problem);
            std::unique_ptr<UsbDevice> device{
                new UsbDevice{std::move(found.identity), std::move(found.handle), label}};
            set_up(*device);
            opened = std::move(device);
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::device) throw;
            refusals.add(error);
        }
        return opened != nullptr;
    });
    if (!opened) refusals.rethrow(selector);
    opened->context_ = std::move(context);
    // Of those that were not asked for nobody wants to hear.
    const bool any = selector.serial.empty() && selector.port.empty();
    if (any && warn)
        for (const std::string& text : refusals.texts()) warn(text + "; the next one is used");
    return opened;
}

}  // namespace eventide
