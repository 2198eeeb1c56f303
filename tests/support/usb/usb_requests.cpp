// What the bus answers to each request of the kernel's interface (usbfs).
#include "tests/support/usb/usb_testbed_parts.h"

#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace eventide::testing_support {

gboolean UsbTestbed::Parts::handle(UMockdevIoctlClient* client) {
    const std::lock_guard lock{mutex};
    const int error =
        answer(umockdev_ioctl_client_get_request(client), umockdev_ioctl_client_get_arg(client));
    umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
    return TRUE;
}

/// 0 or an errno.
int UsbTestbed::Parts::answer(gulong request, UMockdevIoctlData* arg) {
    // What is finished may still be fetched after the cable was pulled.
    if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) {
        if (reap(arg)) return 0;
        return gone ? ENODEV : EAGAIN;
    }
    if (!gone && faults.unplug_after >= 0 && faults.unplug_after-- == 0) pull_cable();
    if (gone) return ENODEV;
    ++requests;
    switch (request) {
        case USBDEVFS_GET_CAPABILITIES:
            return tell_capabilities(arg);
        case USBDEVFS_CLEAR_HALT:
            return clear_halt(arg);
        case USBDEVFS_CLAIMINTERFACE:
            return faults.claimed ? EBUSY : 0;
        case USBDEVFS_RELEASEINTERFACE:
        case USBDEVFS_SETCONFIGURATION:
        case USBDEVFS_SETINTERFACE:
        case USBDEVFS_RESET:
            return 0;
        case USBDEVFS_GETDRIVER:
            return ENODATA;
        case USBDEVFS_SUBMITURB:
            return submit(arg);
        case USBDEVFS_DISCARDURB:
            return discard(arg);
        default:
            return ENOTTY;
    }
}

int UsbTestbed::Parts::clear_halt(UMockdevIoctlData* arg) {
    const Owned<UMockdevIoctlData> endpoint{
        umockdev_ioctl_data_resolve(arg, 0, sizeof(unsigned), nullptr)};
    if (!endpoint) return EFAULT;
    if (endpoint->data[0] != identity.data_endpoint) return 0;
    if (!waiting.empty()) {  // as xHCI: "EP not empty, refuse reset"
        waiting.front().end(-EPIPE);
        finished.push_back(std::move(waiting.front()));
        waiting.pop_front();
        return 0;
    }
    halted = false;
    unread.clear();
    camera->clear_endpoint();
    return 0;
}

int UsbTestbed::Parts::tell_capabilities(UMockdevIoctlData* arg) const {
    const Owned<UMockdevIoctlData> caps{
        umockdev_ioctl_data_resolve(arg, 0, sizeof(guint32), nullptr)};
    if (!caps) return EFAULT;
    const guint32 value = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                          USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
    std::memcpy(caps->data, &value, sizeof value);
    return 0;
}

std::size_t UsbTestbed::Parts::in_flight() const {
    std::size_t bytes = 0;
    for (const UsbUrb& urb : waiting) bytes += urb.room();
    return bytes;
}

int UsbTestbed::Parts::submit(UMockdevIoctlData* arg) {
    UsbUrb urb;
    urb.urb.reset(umockdev_ioctl_data_resolve(arg, 0, sizeof(usbdevfs_urb), nullptr));
    if (!urb.urb) return EFAULT;
    if (in_flight() + urb.room() > faults.memory) return ENOMEM;
    urb.buffer.reset(umockdev_ioctl_data_resolve(urb.urb.get(), offsetof(usbdevfs_urb, buffer),
                                                 urb.room(), nullptr));
    if (!urb.buffer) return EFAULT;
    if (urb->type == USBDEVFS_URB_TYPE_CONTROL) {
        looks = 0;
        controls.push_back(std::move(urb));
        if (faults.control_delay == 0) answer_controls();
    } else {
        auto& urbs = urb->endpoint == identity.data_endpoint ? waiting : listening;
        urbs.push_back(std::move(urb));
    }
    return 0;
}

bool UsbTestbed::Parts::reap(UMockdevIoctlData* arg) {
    if (faults.control_delay != kNever && looks++ >= faults.control_delay) answer_controls();
    if (finished.empty() && !gone) fill_transfers();
    if (finished.empty()) return false;
    const UsbUrb urb = std::move(finished.front());
    finished.pop_front();
    const Owned<UMockdevIoctlData> pointer{
        umockdev_ioctl_data_resolve(arg, 0, sizeof(gpointer), nullptr)};
    return pointer && umockdev_ioctl_data_set_ptr(pointer.get(), 0, urb.urb.get());
}

int UsbTestbed::Parts::discard(UMockdevIoctlData* arg) {
    // The argument is the address of the URB in the client.
    const auto address = *reinterpret_cast<gulong*>(arg->data);
    for (auto* urbs : {&waiting, &listening, &controls})
        if (discard_from(*urbs, address)) return 0;
    return EINVAL;
}

bool UsbTestbed::Parts::discard_from(std::deque<UsbUrb>& urbs, gulong address) {
    const auto found = std::find_if(urbs.begin(), urbs.end(), [&](const UsbUrb& urb) {
        return urb.urb->client_addr == address;
    });
    if (found == urbs.end()) return false;
    found->end(-ENOENT);
    finished.push_back(std::move(*found));
    urbs.erase(found);
    return true;
}

}  // namespace eventide::testing_support
