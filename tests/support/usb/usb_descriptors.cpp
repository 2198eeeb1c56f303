#include "tests/support/usb/usb_descriptors.h"

#include <array>
#include <cstdio>

namespace eventide::testing_support {
namespace {

constexpr std::uint8_t kSerialString = 3;
constexpr std::uint8_t kDevice = 1, kConfiguration = 2, kString = 3, kInterface = 4, kEndpoint = 5;
constexpr std::uint8_t kBulk = 2, kInterrupt = 3;

using Bytes = std::vector<std::uint8_t>;

void put16(std::uint16_t value, Bytes& bytes) {
    bytes.push_back(std::uint8_t(value & 0xFF));
    bytes.push_back(std::uint8_t(value >> 8));
}

void put_endpoint(std::uint8_t address, std::uint8_t kind, std::uint16_t packet, Bytes& bytes) {
    bytes.insert(bytes.end(), {7, kEndpoint, address, kind});
    put16(packet, bytes);
    bytes.push_back(kind == kInterrupt ? 8 : 0);
}

/// Device, one configuration, one interface, bulk IN for the data, interrupt IN for messages.
Bytes descriptors(const UsbModelIdentity& identity) {
    Bytes bytes{18, kDevice};
    put16(identity.superspeed ? 0x0300 : 0x0200, bytes);
    // The largest packet of endpoint 0: a power of two on USB 3, a number before.
    bytes.insert(bytes.end(), {0, 0, 0, std::uint8_t(identity.superspeed ? 9 : 64)});
    put16(identity.vendor, bytes);
    put16(identity.product, bytes);
    bytes.insert(bytes.end(), {identity.firmware, identity.board_type, 1, 2, kSerialString, 1});
    bytes.insert(bytes.end(), {9, kConfiguration, 32, 0, 1, 1, 0, 0x80, 250});
    bytes.insert(bytes.end(), {9, kInterface, 0, 0, 2, 0xFF, 0, 0, 0});
    put_endpoint(identity.data_endpoint, kBulk, identity.superspeed ? 1024 : 512, bytes);
    put_endpoint(0x81, kInterrupt, 64, bytes);
    return bytes;
}

std::string hex(const Bytes& bytes) {
    std::string text;
    for (const std::uint8_t b : bytes) {
        std::array<char, 3> digits{};
        std::snprintf(digits.data(), digits.size(), "%02X", unsigned(b));
        text += digits.data();
    }
    return text;
}

}  // namespace

std::string sysfs_path(const UsbPlace& place) {
    return place.port == 0 ? "/devices/usb1" : "/devices/1-" + std::to_string(place.port);
}

std::string device_node(const UsbPlace& place) {
    std::array<char, 32> node{};
    std::snprintf(node.data(), node.size(), "/dev/bus/usb/001/%03d", place.address);
    return node.data();
}

std::string device_record(const UsbModelIdentity& identity, const UsbPlace& place) {
    const std::string node = device_node(place), number = node.substr(node.size() - 3);
    return "P: " + sysfs_path(place) + "\nN: " + node.substr(5) +
           "\nE: BUSNUM=001\nE: DEVNUM=" + number + "\nE: DEVNAME=" + node +
           "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: MAJOR=189\nE: MINOR=" +
           std::to_string(place.address - 1) +
           "\nA: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum=" +
           std::to_string(place.address) +
           "\\n\nA: speed=" + std::string{identity.superspeed ? "5000" : "480"} +
           "\\n\n"
           "H: descriptors=" +
           hex(descriptors(identity)) + "\n";
}

std::vector<std::uint8_t> string_descriptor(const UsbModelIdentity& identity, std::uint8_t index) {
    constexpr std::uint16_t kEnglish = 0x0409;
    Bytes text{0, kString};
    if (index == 0)
        put16(kEnglish, text);
    else
        for (const char c : index == kSerialString ? identity.serial : "DAVIS")
            put16(std::uint16_t(c), text);
    text[0] = std::uint8_t(text.size());
    return text;
}

}  // namespace eventide::testing_support
