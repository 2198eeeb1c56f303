// What can be plugged into a UsbTestbed: a device's name, its answers, its stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace eventide::testing_support {

struct UsbModelIdentity {
    std::uint16_t vendor = 0x152A, product = 0;
    std::uint8_t firmware = 0, board_type = 0;  ///< low and high byte of bcdDevice
    std::string serial;
    std::uint8_t data_endpoint = 0x82;  ///< bulk IN
    bool superspeed = true;             ///< USB 3, else high speed
};

/// The eight bytes that begin a control request.
struct UsbSetup {
    std::uint8_t type = 0, request = 0;
    std::uint16_t value = 0, index = 0;
};

/// Thread: one at a time; the testbed locks.
class UsbModel {
public:
    virtual ~UsbModel() = default;

    virtual UsbModelIdentity identity() const = 0;
    /// A request to the device itself (`data` is what it gets, or where its answer goes): bytes
    /// transferred, or -1 for a request it does not know, which stalls. Standard requests are the
    /// testbed's.
    virtual int control(const UsbSetup& setup, std::span<std::uint8_t> data) = 0;
    /// The next bytes of the data endpoint, at most out.size(); 0 when there are none now.
    virtual std::size_t send(std::span<std::byte> out) = 0;
    /// The next message of the interrupt endpoint, as send().
    virtual std::size_t message(std::span<std::byte>) { return 0; }
    /// CLEAR_HALT on the data endpoint: what was queued is dropped.
    virtual void clear_endpoint() = 0;
};

}  // namespace eventide::testing_support
