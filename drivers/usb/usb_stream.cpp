#include "drivers/usb/usb_stream.h"

#include "drivers/usb/usb_device.h"
#include "src/core/error.h"

#include <libusb-1.0/libusb.h>

#include <string>
#include <utility>

namespace eventide {
namespace {

/// An endpoint that halts as often without giving anything between will not recover.
constexpr int kMaxHaltsInARow = 8;
/// As many and as long as libcaer asks for (LC src/dvxplorer.h).
constexpr int kMessageTransfers = 4;
constexpr std::size_t kMessageBytes = 64;

}  // namespace

struct UsbStream::Transfer {
    UsbStream* stream = nullptr;
    Pipe* pipe = nullptr;
    libusb_transfer* raw = nullptr;
    std::vector<std::byte> buffer;
    ~Transfer() { libusb_free_transfer(raw); }
};

UsbStreamSettings fitting(UsbStreamSettings settings, bool superspeed) {
    constexpr UsbStreamSettings kUsb3{32, 128 * 1024}, kUsb2{128, 8 * 1024};
    const UsbStreamSettings& usual = superspeed ? kUsb3 : kUsb2;
    // As many as there are of the small ones would be too much memory for a user's larger ones.
    if (settings.transfers == 0)
        settings.transfers = settings.bytes == 0 ? usual.transfers : kUsb3.transfers;
    if (settings.bytes == 0) settings.bytes = usual.bytes;
    return settings;
}

UsbStream::UsbStream(libusb_context* context, libusb_device_handle* handle, UsbEndpoints endpoints,
                     const UsbStreamSettings& settings)
    : context_(context),
      handle_(handle),
      data_{.endpoint = endpoints.data, .transfers = settings.transfers, .bytes = settings.bytes},
      messages_{.endpoint = endpoints.messages,
                .transfers = endpoints.messages == 0 ? 0 : kMessageTransfers,
                .bytes = kMessageBytes} {
    add_transfers(data_);
    add_transfers(messages_);
    for (const auto& transfer : transfers_) {
        const int code = submit(*transfer);
        if (code == 0) continue;
        if (transfer->pipe == &messages_) {
            give_up(messages_);
            break;
        }
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

void UsbStream::add_transfers(Pipe& pipe) {
    for (int i = 0; i < pipe.transfers; ++i) {
        auto transfer = std::make_unique<Transfer>();
        transfer->stream = this;
        transfer->pipe = &pipe;
        transfer->raw = libusb_alloc_transfer(0);
        if (transfer->raw == nullptr)
            throw Error(ErrorKind::device, "USB: no memory for a transfer");
        transfer->buffer.resize(pipe.bytes);
        const auto fill =
            &pipe == &data_ ? libusb_fill_bulk_transfer : libusb_fill_interrupt_transfer;
        fill(transfer->raw, handle_, pipe.endpoint, nullptr, 0, &UsbStream::completed,
             transfer.get(), 0);
        transfers_.push_back(std::move(transfer));
    }
}

UsbStream::~UsbStream() {
    cancel_all();
}

void UsbStream::cancel(const Pipe& pipe) {
    for (const auto& transfer : transfers_)
        if (transfer->pipe == &pipe) libusb_cancel_transfer(transfer->raw);
}

/// Once is not enough: a transfer may complete just before it is cancelled.
void UsbStream::cancel_all() {
    stopping_ = true;
    while (data_.active + messages_.active > 0) {
        cancel(data_);
        cancel(messages_);
        handle_events(std::chrono::milliseconds{1});
    }
}

int UsbStream::submit(Transfer& transfer) {
    transfer.buffer.resize(transfer.pipe->bytes);
    transfer.raw->buffer = reinterpret_cast<unsigned char*>(transfer.buffer.data());
    transfer.raw->length = int(transfer.pipe->bytes);
    const int code = libusb_submit_transfer(transfer.raw);
    transfer.pipe->active += code == 0 ? 1 : 0;
    return code;
}

void UsbStream::resubmit(Transfer& transfer) {
    Pipe& pipe = *transfer.pipe;
    if (lost_ || stopping_ || pipe.given_up) return;
    if (pipe.halted)
        pipe.resting.push_back(&transfer);
    else if (submit(transfer) != 0)
        give_up(pipe);
}

/// Without data the device is of no use; without messages it is, and libcaer goes on too.
void UsbStream::give_up(Pipe& pipe) {
    pipe.given_up = true;
    lost_ = lost_ || &pipe == &data_;
}

void UsbStream::completed(libusb_transfer* raw) {
    auto& transfer = *static_cast<Transfer*>(raw->user_data);
    UsbStream& stream = *transfer.stream;
    Pipe& pipe = *transfer.pipe;
    --pipe.active;
    switch (raw->status) {
        case LIBUSB_TRANSFER_COMPLETED:
        case LIBUSB_TRANSFER_TIMED_OUT:
        case LIBUSB_TRANSFER_CANCELLED:
        case LIBUSB_TRANSFER_OVERFLOW:
            break;
        case LIBUSB_TRANSFER_STALL:
            pipe.halted = true;
            break;
        default:
            stream.give_up(pipe);  // error, no device
    }
    // Bytes that came before the end are good, whatever ended the transfer.
    if (raw->actual_length > 0)
        stream.done_.push_back({&transfer, std::exchange(pipe.gap, false)});
    else
        stream.resubmit(transfer);
    // The device sent more than there was room for.
    if (raw->status == LIBUSB_TRANSFER_OVERFLOW) pipe.gap = true;
}

UsbStream::Status UsbStream::take(std::vector<std::byte>& into) {
    if (done_.empty()) return Status::timeout;
    Transfer& transfer = *done_.front().transfer;
    gap_before_ = done_.front().gap_before;
    done_.pop_front();
    transfer.buffer.resize(std::size_t(transfer.raw->actual_length));
    const bool is_data = transfer.pipe == &data_;
    if (is_data)
        into.swap(transfer.buffer);
    else  // a few bytes: their small buffer must not come to hold data
        into.assign(transfer.buffer.begin(), transfer.buffer.end());
    transfer.pipe->halts_in_a_row = 0;
    resubmit(transfer);
    return is_data ? Status::data : Status::message;
}

/// Nothing comes from a halted endpoint until this was done, and what the device had queued is
/// lost. First all its transfers come back: a host controller does not begin an endpoint anew that
/// has any (xHCI refuses), and where only the device does, they no longer understand each other.
void UsbStream::clear_halt(Pipe& pipe) {
    if (pipe.active > 0) return cancel(pipe);
    const bool hopeless = ++pipe.halts_in_a_row > kMaxHaltsInARow;
    if (hopeless && &pipe == &data_)
        throw Error(ErrorKind::device,
                    "USB: the camera's data endpoint stalls again each time it is cleared: plug "
                    "the camera in again");
    if (hopeless || libusb_clear_halt(handle_, pipe.endpoint) != 0) return give_up(pipe);
    ++halts_;
    pipe.halted = false;
    pipe.gap = true;
    for (Transfer* transfer : std::exchange(pipe.resting, {})) resubmit(*transfer);
}

void UsbStream::handle_events(std::chrono::milliseconds timeout) {
    timeval time{};
    time.tv_sec = long(timeout.count() / 1000);
    time.tv_usec = long(timeout.count() % 1000) * 1000;
    libusb_handle_events_timeout_completed(context_, &time, nullptr);
}

UsbStream::Status UsbStream::read(std::vector<std::byte>& into, std::chrono::milliseconds timeout) {
    if (const Status taken = take(into); taken != Status::timeout) return taken;
    for (Pipe* pipe : {&data_, &messages_})
        if (pipe->halted && !pipe->given_up && !lost_) clear_halt(*pipe);
    if (lost_) return Status::lost;
    handle_events(timeout);
    if (const Status taken = take(into); taken != Status::timeout) return taken;
    return lost_ ? Status::lost : Status::timeout;
}

}  // namespace eventide
