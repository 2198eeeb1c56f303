// How transfers end: answered by the camera, by a fault, or by the cable.
#include "src/core/byte_order.h"
#include "tests/support/usb/usb_testbed_parts.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <span>

namespace eventide::testing_support {
namespace {

constexpr int kSetupBytes = 8;

}  // namespace

void UsbTestbed::Parts::pull_cable() {
    gone = true;
    faults.unplug_after = -1;
    for (auto* urbs : {&controls, &waiting, &listening}) {
        for (UsbUrb& urb : *urbs) {
            urb.end(-ESHUTDOWN);
            finished.push_back(std::move(urb));
        }
        urbs->clear();
    }
}

void UsbTestbed::Parts::answer_controls() {
    for (UsbUrb& urb : controls) {
        const int n = faults.control_stalls > 0 ? (--faults.control_stalls, -1) : control(urb);
        urb.end(n < 0 ? -EPIPE : 0, std::max(n, 0));
        finished.push_back(std::move(urb));
    }
    controls.clear();
}

/// Bytes transferred, or -1 for a request the camera does not know.
int UsbTestbed::Parts::control(const UsbUrb& urb) {
    constexpr std::uint8_t kStandardIn = 0x80, kGetDescriptor = 6, kString = 3;
    const std::uint8_t* bytes = urb.buffer->data;
    const auto word = [&](int at) {
        return load_little<std::uint16_t>(reinterpret_cast<const std::byte*>(bytes + at));
    };
    const UsbSetup setup{bytes[0], bytes[1], word(2), word(4)};
    const std::span data{urb.buffer->data + kSetupBytes, urb.room() - kSetupBytes};
    if (setup.type != kStandardIn) return camera->control(setup, data);
    if (setup.request != kGetDescriptor || setup.value >> 8 != kString) return -1;
    const auto text = string_descriptor(identity, std::uint8_t(setup.value & 0xFF));
    const std::size_t n = std::min(data.size(), text.size());
    std::copy_n(text.begin(), n, data.begin());
    return int(n);
}

/// Bulk requests are answered in order, when the camera has something to say.
void UsbTestbed::Parts::fill_transfers() {
    tell_messages();
    while (!waiting.empty() && !halted) {
        UsbUrb& urb = waiting.front();
        if (faults.halts > 0) {
            --faults.halts;
            halted = true;
            urb.end(-EPIPE);
        } else {
            std::size_t room = urb.room();
            if (faults.transfer_limit != 0) room = std::min(room, faults.transfer_limit);
            std::size_t n = send({reinterpret_cast<std::byte*>(urb.buffer->data), room});
            if (n == 0) return;
            if (faults.loses_byte_of_every > 0 && ++transfers % faults.loses_byte_of_every == 0)
                --n;
            urb.end(overflows() ? -EOVERFLOW : 0, int(n));
        }
        finished.push_back(std::move(urb));
        waiting.pop_front();
        tell_messages();
    }
}

std::size_t UsbTestbed::Parts::send(std::span<std::byte> out) {
    if (unread.empty()) return camera->send(out);
    const std::size_t n = std::min(out.size(), unread.size());
    std::copy_n(unread.begin(), n, out.begin());
    unread.erase(unread.begin(), unread.begin() + std::ptrdiff_t(n));
    return n;
}

/// Whether more comes than a transfer has room for; what that is, is lost.
bool UsbTestbed::Parts::overflows() {
    if (faults.overflows == 0) return false;
    --faults.overflows;
    std::array<std::byte, 512> lost{};
    camera->send(lost);
    return true;
}

void UsbTestbed::Parts::tell_messages() {
    while (!listening.empty()) {
        UsbUrb& urb = listening.front();
        const std::size_t n =
            camera->message({reinterpret_cast<std::byte*>(urb.buffer->data), urb.room()});
        if (n == 0) return;
        urb.end(-faults.message_error, faults.message_error == 0 ? int(n) : 0);
        finished.push_back(std::move(urb));
        listening.pop_front();
    }
}

}  // namespace eventide::testing_support
