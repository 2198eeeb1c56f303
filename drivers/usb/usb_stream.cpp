#include "drivers/usb/usb_stream.h"

#include "drivers/usb/usb_device.h"
#include "src/core/error.h"

#include <libusb-1.0/libusb.h>

#include <string>
#include <utility>

namespace eventide {
namespace {

/// An endpoint that halts as often without giving anything between will not recover.
constexpr int kMostHaltsInARow = 8;

}  // namespace

struct UsbStream::Transfer {
    UsbStream* stream = nullptr;
    libusb_transfer* raw = nullptr;
    std::vector<std::byte> buffer;
    ~Transfer() { libusb_free_transfer(raw); }
};

UsbStream::UsbStream(libusb_context* context, libusb_device_handle* handle, std::uint8_t endpoint,
                     const UsbStreamSettings& settings)
    : context_(context), handle_(handle), endpoint_(endpoint), settings_(settings) {
    for (int i = 0; i < settings.transfers; ++i) {
        auto transfer = std::make_unique<Transfer>();
        transfer->stream = this;
        transfer->raw = libusb_alloc_transfer(0);
        if (transfer->raw == nullptr)
            throw Error(ErrorKind::device, "USB: no memory for a transfer");
        transfer->buffer.resize(settings.bytes);
        libusb_fill_bulk_transfer(transfer->raw, handle, endpoint, nullptr, 0,
                                  &UsbStream::completed, transfer.get(), 0);
        transfers_.push_back(std::move(transfer));
    }
    for (const auto& transfer : transfers_) {
        const int code = submit(*transfer);
        if (code == 0) continue;
        cancel_all();
        if (code == LIBUSB_ERROR_NO_MEM)
            throw Error(ErrorKind::device,
                        "USB: the kernel has no memory for " + std::to_string(settings.transfers) +
                            " transfers of " + std::to_string(settings.bytes) +
                            " bytes: ask for fewer or smaller ones, or allow more in "
                            "/sys/module/usbcore/parameters/usbfs_memory_mb");
        check_usb(code, "the camera takes no transfers");
    }
}

UsbStream::~UsbStream() {
    cancel_all();
}

/// Once is not enough: a transfer may complete just before it is cancelled.
void UsbStream::cancel_all() {
    stopping_ = true;
    while (active_ > 0) {
        for (const auto& transfer : transfers_) libusb_cancel_transfer(transfer->raw);
        handle_events(std::chrono::milliseconds{1});
    }
}

int UsbStream::submit(Transfer& transfer) {
    transfer.buffer.resize(settings_.bytes);
    transfer.raw->buffer = reinterpret_cast<unsigned char*>(transfer.buffer.data());
    transfer.raw->length = int(settings_.bytes);
    const int code = libusb_submit_transfer(transfer.raw);
    active_ += code == 0 ? 1 : 0;
    return code;
}

void UsbStream::resubmit(Transfer& transfer) {
    if (lost_ || stopping_) return;
    if (halted_)
        resting_.push_back(&transfer);
    else if (submit(transfer) != 0)
        lost_ = true;
}

void UsbStream::completed(libusb_transfer* raw) {
    auto& transfer = *static_cast<Transfer*>(raw->user_data);
    UsbStream& stream = *transfer.stream;
    --stream.active_;
    switch (raw->status) {
        case LIBUSB_TRANSFER_COMPLETED:
        case LIBUSB_TRANSFER_TIMED_OUT:
        case LIBUSB_TRANSFER_CANCELLED:
        case LIBUSB_TRANSFER_OVERFLOW:
            break;
        case LIBUSB_TRANSFER_STALL:
            stream.halted_ = true;
            break;
        default:
            stream.lost_ = true;  // error, no device
    }
    // Bytes that came before the end are good, whatever ended the transfer.
    if (raw->actual_length > 0)
        stream.done_.push_back({&transfer, std::exchange(stream.gap_, false)});
    else
        stream.resubmit(transfer);
    // The device sent more than there was room for.
    if (raw->status == LIBUSB_TRANSFER_OVERFLOW) stream.gap_ = true;
}

bool UsbStream::take(std::vector<std::byte>& into) {
    if (done_.empty()) return false;
    Transfer& transfer = *done_.front().transfer;
    gap_before_ = done_.front().gap_before;
    done_.pop_front();
    transfer.buffer.resize(std::size_t(transfer.raw->actual_length));
    into.swap(transfer.buffer);
    resubmit(transfer);
    halts_in_a_row_ = 0;
    return true;
}

/// Nothing comes from a halted endpoint until this was done, and what the device had queued is
/// lost.
void UsbStream::clear_halt() {
    if (++halts_in_a_row_ > kMostHaltsInARow)
        throw Error(
            ErrorKind::device,
            "USB: the camera's data endpoint stalls again each time it is cleared: plug the "
            "camera in again");
    if (libusb_clear_halt(handle_, endpoint_) != 0) {
        lost_ = true;
        return;
    }
    ++halts_;
    halted_ = false;
    gap_ = true;
    for (Transfer* transfer : std::exchange(resting_, {})) resubmit(*transfer);
}

void UsbStream::handle_events(std::chrono::milliseconds patience) {
    timeval time{};
    time.tv_sec = long(patience.count() / 1000);
    time.tv_usec = long(patience.count() % 1000) * 1000;
    libusb_handle_events_timeout_completed(context_, &time, nullptr);
}

UsbStream::Status UsbStream::read(std::vector<std::byte>& into,
                                  std::chrono::milliseconds patience) {
    if (take(into)) return Status::data;
    if (halted_ && !lost_) clear_halt();
    if (lost_) return Status::lost;
    handle_events(patience);
    if (take(into)) return Status::data;
    return lost_ ? Status::lost : Status::timeout;
}

}  // namespace eventide
