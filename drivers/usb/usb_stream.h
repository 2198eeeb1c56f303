// Bulk transfers in flight: bytes from the camera without a copy and without a thread of its own.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

struct libusb_context;
struct libusb_device_handle;
struct libusb_transfer;

namespace eventide {

struct UsbStreamSettings {
    int transfers = 32;              ///< in flight
    std::size_t bytes = 128 * 1024;  ///< of each; a multiple of the endpoint's packet (1024)
};

/// read() runs libusb's event handling on the caller's thread, and a completed transfer swaps its
/// buffer with the caller's. A transfer goes back in flight as soon as its bytes were taken. An
/// endpoint that halts is cleared, and the stream goes on behind a gap.
class UsbStream {
public:
    enum class Status { data, timeout, lost };

    /// Throws UsbGone, or Error (device) when the kernel has no memory for so many transfers.
    UsbStream(libusb_context* context, libusb_device_handle* handle, std::uint8_t endpoint,
              const UsbStreamSettings& settings);
    /// Cancels what is in flight and waits until libusb has let go of every transfer.
    ~UsbStream();
    UsbStream(const UsbStream&) = delete;
    UsbStream& operator=(const UsbStream&) = delete;

    /// Source thread. Waits at most `patience`. After `lost` the device is gone and nothing more
    /// will come. Throws Error (device) for an endpoint that halts again and again.
    Status read(std::vector<std::byte>& into, std::chrono::milliseconds patience);

    /// Bytes were lost before those that read() gave last.
    bool gap_before() const { return gap_before_; }
    /// Times the endpoint was cleared since this was asked last.
    std::uint64_t take_halts() { return std::exchange(halts_, 0); }

private:
    struct Transfer;
    struct Done {
        Transfer* transfer;
        bool gap_before;
    };
    static void completed(libusb_transfer* raw);
    int submit(Transfer& transfer);
    void resubmit(Transfer& transfer);
    void cancel_all();
    void clear_halt();
    bool take(std::vector<std::byte>& into);
    void handle_events(std::chrono::milliseconds patience);

    libusb_context* context_;
    libusb_device_handle* handle_;
    std::uint8_t endpoint_;
    UsbStreamSettings settings_;
    std::vector<std::unique_ptr<Transfer>> transfers_;
    std::deque<Done> done_;           ///< completed, in order, bytes not yet taken
    std::vector<Transfer*> resting_;  ///< until the halt is cleared
    int active_ = 0;                  ///< with libusb
    bool stopping_ = false, lost_ = false, halted_ = false;
    bool gap_ = false, gap_before_ = false;
    int halts_in_a_row_ = 0;
    std::uint64_t halts_ = 0;
};

}  // namespace eventide
