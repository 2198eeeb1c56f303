// Bulk transfers in flight: bytes from the camera without a copy and without a thread of its own.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

struct libusb_context;
struct libusb_device_handle;
struct libusb_transfer;

namespace eventide {

struct UsbStreamSettings {
    int transfers = 16;             ///< in flight
    std::size_t bytes = 64 * 1024;  ///< of each; a multiple of the endpoint's packet (1024)
};

/// read() runs libusb's event handling on the caller's thread, and a completed transfer swaps its
/// buffer with the caller's. A transfer goes back in flight as soon as its bytes were taken.
class UsbStream {
public:
    enum class Status { data, timeout, lost };

    UsbStream(libusb_context* context, libusb_device_handle* handle, std::uint8_t endpoint,
              const UsbStreamSettings& settings);
    /// Cancels what is in flight and waits until libusb has let go of every transfer.
    ~UsbStream();
    UsbStream(const UsbStream&) = delete;
    UsbStream& operator=(const UsbStream&) = delete;

    /// Source thread. Waits at most `patience`. After `lost` the device is gone and nothing more
    /// will come.
    Status read(std::vector<std::byte>& into, std::chrono::milliseconds patience);

private:
    struct Transfer;
    static void completed(libusb_transfer* raw);
    void submit(Transfer& transfer);
    bool take(std::vector<std::byte>& into);
    void handle_events(std::chrono::milliseconds patience);

    libusb_context* context_;
    UsbStreamSettings settings_;
    std::vector<std::unique_ptr<Transfer>> transfers_;
    std::deque<Transfer*> done_;  ///< completed, in order, bytes not yet taken
    int active_ = 0;              ///< with libusb
    bool stopping_ = false, lost_ = false;
};

}  // namespace eventide
