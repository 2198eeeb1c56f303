#include "drivers/usb/usb_stream.h"

#include "drivers/usb/usb_device.h"
#include "src/core/error.h"

#include <libusb-1.0/libusb.h>

namespace eventide {

struct UsbStream::Transfer {
    UsbStream* stream = nullptr;
    libusb_transfer* raw = nullptr;
    std::vector<std::byte> buffer;
    ~Transfer() { libusb_free_transfer(raw); }
};

UsbStream::UsbStream(libusb_context* context, libusb_device_handle* handle, std::uint8_t endpoint,
                     const UsbStreamSettings& settings)
    : context_(context), settings_(settings) {
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
    for (const auto& transfer : transfers_) submit(*transfer);
    if (active_ == 0)
        throw Error(ErrorKind::device, "USB: the camera takes no transfers: was it unplugged?");
}

UsbStream::~UsbStream() {
    stopping_ = true;
    // Once is not enough: a transfer may complete just before it is cancelled.
    while (active_ > 0) {
        for (const auto& transfer : transfers_) libusb_cancel_transfer(transfer->raw);
        handle_events(std::chrono::milliseconds{1});
    }
}

void UsbStream::submit(Transfer& transfer) {
    transfer.buffer.resize(settings_.bytes);
    transfer.raw->buffer = reinterpret_cast<unsigned char*>(transfer.buffer.data());
    transfer.raw->length = int(settings_.bytes);
    if (libusb_submit_transfer(transfer.raw) == 0)
        ++active_;
    else
        lost_ = true;
}

void UsbStream::completed(libusb_transfer* raw) {
    auto& transfer = *static_cast<Transfer*>(raw->user_data);
    UsbStream& stream = *transfer.stream;
    --stream.active_;
    // Bytes that came before the end are good, whatever ended the transfer.
    if (raw->actual_length > 0) stream.done_.push_back(&transfer);
    switch (raw->status) {
        case LIBUSB_TRANSFER_COMPLETED:
        case LIBUSB_TRANSFER_TIMED_OUT:
        case LIBUSB_TRANSFER_OVERFLOW:
            if (raw->actual_length == 0 && !stream.stopping_) stream.submit(transfer);
            return;
        case LIBUSB_TRANSFER_CANCELLED:
            return;
        default:
            stream.lost_ = true;  // stall, error, no device
    }
}

bool UsbStream::take(std::vector<std::byte>& into) {
    if (done_.empty()) return false;
    Transfer& transfer = *done_.front();
    done_.pop_front();
    transfer.buffer.resize(std::size_t(transfer.raw->actual_length));
    into.swap(transfer.buffer);
    if (!lost_) submit(transfer);
    return true;
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
    if (lost_) return Status::lost;
    handle_events(patience);
    if (take(into)) return Status::data;
    return lost_ ? Status::lost : Status::timeout;
}

}  // namespace eventide
