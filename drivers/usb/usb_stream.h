// Transfers in flight: bytes from the camera without a copy and without a thread of its own.
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

/// 0: as fits the bus.
struct UsbStreamSettings {
    int transfers = 0;      ///< in flight
    std::size_t bytes = 0;  ///< of each; a multiple of the endpoint's packet (1024)
};

/// Settles what was left open. A camera ends a transfer early only with a buffer that did not fill
/// within a millisecond: 512 bytes on USB 2, 8 KiB on USB 3 (docs/protocols.md A.2). Above that
/// rate a transfer lasts until it is full, so its size bounds the latency: 16 ms with 8 KiB on USB
/// 2 and with 128 KiB on USB 3.
UsbStreamSettings fitting(UsbStreamSettings settings, bool superspeed);

/// Where the bytes come from.
struct UsbEndpoints {
    std::uint8_t data = 0x82;   ///< bulk IN
    std::uint8_t messages = 0;  ///< interrupt IN, at most 64 bytes each; 0: not listened to
};

/// read() runs libusb's event handling on the caller's thread, and a completed transfer swaps its
/// buffer with the caller's. A transfer goes back in flight as soon as its bytes were taken. An
/// endpoint that halts is cleared, and the stream goes on behind a gap. Messages that cannot be had
/// do not stop the data.
class UsbStream {
public:
    enum class Status { data, message, timeout, lost };

    /// Throws UsbDisconnected, or Error (device) when the kernel has no memory for so many
    /// transfers.
    UsbStream(libusb_context* context, libusb_device_handle* handle, UsbEndpoints endpoints,
              const UsbStreamSettings& settings);
    /// Cancels what is in flight and waits until libusb has let go of every transfer.
    ~UsbStream();
    UsbStream(const UsbStream&) = delete;
    UsbStream& operator=(const UsbStream&) = delete;

    /// Source thread. Waits at most `timeout`. Data and messages come in the order in which they
    /// arrived. After `lost` the device is gone and nothing more will come. Throws Error (device)
    /// for an endpoint that halts again and again.
    Status read(std::vector<std::byte>& into, std::chrono::milliseconds timeout);

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
    /// One endpoint, and what became of it.
    struct Pipe {
        std::uint8_t endpoint = 0;
        int transfers = 0, active = 0;  ///< of them: with libusb
        std::size_t bytes = 0;
        bool halted = false, gap = false, given_up = false;
        int halts_in_a_row = 0;
        std::vector<Transfer*> resting{};  ///< until the halt is cleared
    };
    static void completed(libusb_transfer* raw);
    void add_transfers(Pipe& pipe);
    int submit(Transfer& transfer);
    void resubmit(Transfer& transfer);
    void cancel(const Pipe& pipe);
    void cancel_all();
    void give_up(Pipe& pipe);
    void clear_halt(Pipe& pipe);
    Status take(std::vector<std::byte>& into);
    void handle_events(std::chrono::milliseconds timeout);

    libusb_context* context_;
    libusb_device_handle* handle_;
    Pipe data_, messages_;
    std::vector<std::unique_ptr<Transfer>> transfers_;
    std::deque<Done> done_;  ///< completed, in order, bytes not yet taken
    bool stopping_ = false, lost_ = false, gap_before_ = false;
    std::uint64_t halts_ = 0;
};

}  // namespace eventide
