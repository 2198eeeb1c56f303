#include "tests/support/usb_testbed.h"

#include "tests/support/glib_owned.h"
#include "tests/support/preload.h"
#include "tests/support/usb_descriptors.h"

#include <sys/ioctl.h>

#include <linux/usbdevice_fs.h>
#include <umockdev.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <string>

namespace eventide::testing_support {
namespace {

constexpr const char* kSysfsPath = "/sys/devices/usb1";
constexpr const char* kNode = "/dev/bus/usb/001/001";
constexpr int kSetupBytes = 8;

std::uint16_t little16(const std::uint8_t* at) {
    return std::uint16_t(at[0] | (at[1] << 8));
}

/// One transfer of the program under test, in its memory.
struct Urb {
    Owned<UMockdevIoctlData> urb, buffer;
    usbdevfs_urb* operator->() const { return reinterpret_cast<usbdevfs_urb*>(urb->data); }
    std::size_t room() const { return std::size_t((*this)->buffer_length); }
    void end(int status, int length = 0) const {
        (*this)->status = status;
        (*this)->actual_length = length;
    }
};

struct Faults {
    int control_stalls = 0, control_delay = 0, halts = 0, loses_byte_of_every = 0;
    int unplug_after = -1, message_error = 0;
    std::size_t transfer_limit = 0, memory = SIZE_MAX;
};

}  // namespace

struct UsbTestbed::Parts {
    Owned<UMockdevTestbed> testbed;
    Owned<UMockdevIoctlBase> handler;
    std::mutex mutex;  // for all below: requests come on umockdev's thread
    std::shared_ptr<UsbModel> camera;
    UsbModelIdentity identity;
    bool attached = false, gone = true, halted = false;
    int requests = 0, looks = 0, transfers = 0;
    std::deque<Urb> controls;                      // not yet answered
    std::deque<Urb> waiting, listening, finished;  // for data, for messages
    Faults faults;

    static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer parts) {
        return static_cast<Parts*>(parts)->handle(client);
    }
    gboolean handle(UMockdevIoctlClient* client);
    int answer(gulong request, UMockdevIoctlData* arg);
    void pull_cable();
    int clear_halt(UMockdevIoctlData* arg);
    int tell_capabilities(UMockdevIoctlData* arg) const;
    int submit(UMockdevIoctlData* arg);
    bool reap(UMockdevIoctlData* arg);
    int discard(UMockdevIoctlData* arg);
    bool discard_from(std::deque<Urb>& urbs, gulong address);
    void answer_controls();
    int control(const Urb& urb);
    void fill_transfers();
    void tell_messages();
    std::size_t in_flight() const;
};

UsbTestbed::UsbTestbed() : parts_(std::make_unique<Parts>()) {
    if (!runs_in_testbed())
        throw std::runtime_error("the USB testbed needs umockdev's preload library");
    parts_->testbed.reset(umockdev_testbed_new());
    parts_->handler.reset(umockdev_ioctl_base_new());
    g_signal_connect(parts_->handler.get(), "handle-ioctl", G_CALLBACK(&Parts::on_ioctl),
                     parts_.get());
}

UsbTestbed::~UsbTestbed() {
    unplug();
}

// ---- plugging ----------------------------------------------------------------------------------

void UsbTestbed::plug_in(std::shared_ptr<UsbModel> camera) {
    Parts& p = *parts_;
    {
        const std::lock_guard lock{p.mutex};
        p.camera = std::move(camera);
        p.identity = p.camera->identity();
        p.gone = p.halted = false;
        p.requests = p.looks = p.transfers = 0;
    }
    GError* error = nullptr;
    const std::string record = device_record(p.identity);
    if (!umockdev_testbed_add_from_string(p.testbed.get(), record.c_str(), &error) ||
        !umockdev_testbed_attach_ioctl(p.testbed.get(), kNode, p.handler.get(), &error)) {
        const Owned<GError> owned{error};
        throw std::runtime_error(std::string{"umockdev: "} + owned->message);
    }
    p.attached = true;
    umockdev_testbed_uevent(p.testbed.get(), kSysfsPath, "add");
}

void UsbTestbed::unplug() {
    Parts& p = *parts_;
    if (!p.attached) return;
    {
        const std::lock_guard lock{p.mutex};
        p.pull_cable();
    }
    umockdev_testbed_uevent(p.testbed.get(), kSysfsPath, "remove");
    umockdev_testbed_detach_ioctl(p.testbed.get(), kNode, nullptr);
    umockdev_testbed_remove_device(p.testbed.get(), kSysfsPath);
    p.attached = false;
}

void UsbTestbed::Parts::pull_cable() {
    gone = true;
    faults.unplug_after = -1;
    for (auto* urbs : {&controls, &waiting, &listening}) {
        for (Urb& urb : *urbs) {
            urb.end(-ESHUTDOWN);
            finished.push_back(std::move(urb));
        }
        urbs->clear();
    }
}

// ---- faults ------------------------------------------------------------------------------------

void UsbTestbed::unplug_after(int requests) {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.unplug_after = requests;
}

int UsbTestbed::requests() const {
    const std::lock_guard lock{parts_->mutex};
    return parts_->requests;
}

void UsbTestbed::stall_control(int requests) {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.control_stalls = requests;
}

void UsbTestbed::delay_control(int looks) {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.control_delay = looks;
}

void UsbTestbed::halt_data(int times) {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.halts = times;
}

void UsbTestbed::fail_messages(int error) {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.message_error = error;
}

void UsbTestbed::limit_transfer(std::size_t bytes) {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.transfer_limit = bytes;
}

void UsbTestbed::lose_last_byte_of_every(int transfers) {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.loses_byte_of_every = transfers;
}

void UsbTestbed::limit_memory(std::size_t bytes) {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.memory = bytes;
}

void UsbTestbed::look(const std::function<void()>& at) {
    const std::lock_guard lock{parts_->mutex};
    at();
}

// ---- requests ----------------------------------------------------------------------------------

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
    halted = false;
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
    for (const Urb& urb : waiting) bytes += urb.room();
    return bytes;
}

int UsbTestbed::Parts::submit(UMockdevIoctlData* arg) {
    Urb urb;
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
    const Urb urb = std::move(finished.front());
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

bool UsbTestbed::Parts::discard_from(std::deque<Urb>& urbs, gulong address) {
    const auto found = std::find_if(
        urbs.begin(), urbs.end(), [&](const Urb& urb) { return urb.urb->client_addr == address; });
    if (found == urbs.end()) return false;
    found->end(-ENOENT);
    finished.push_back(std::move(*found));
    urbs.erase(found);
    return true;
}

void UsbTestbed::Parts::answer_controls() {
    for (Urb& urb : controls) {
        const int n = faults.control_stalls > 0 ? (--faults.control_stalls, -1) : control(urb);
        urb.end(n < 0 ? -EPIPE : 0, std::max(n, 0));
        finished.push_back(std::move(urb));
    }
    controls.clear();
}

/// Bytes transferred, or -1 for a request the camera does not know.
int UsbTestbed::Parts::control(const Urb& urb) {
    constexpr std::uint8_t kStandardIn = 0x80, kGetDescriptor = 6, kString = 3;
    const std::uint8_t* bytes = urb.buffer->data;
    const UsbSetup setup{bytes[0], bytes[1], little16(bytes + 2), little16(bytes + 4)};
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
        Urb& urb = waiting.front();
        if (faults.halts > 0) {
            --faults.halts;
            halted = true;
            urb.end(-EPIPE);
        } else {
            std::size_t room = urb.room();
            if (faults.transfer_limit != 0) room = std::min(room, faults.transfer_limit);
            std::size_t n = camera->send({reinterpret_cast<std::byte*>(urb.buffer->data), room});
            if (n == 0) return;
            if (faults.loses_byte_of_every > 0 && ++transfers % faults.loses_byte_of_every == 0)
                --n;
            urb.end(0, int(n));
        }
        finished.push_back(std::move(urb));
        waiting.pop_front();
        tell_messages();
    }
}

void UsbTestbed::Parts::tell_messages() {
    while (!listening.empty()) {
        Urb& urb = listening.front();
        const std::size_t n =
            camera->message({reinterpret_cast<std::byte*>(urb.buffer->data), urb.room()});
        if (n == 0) return;
        urb.end(-faults.message_error, faults.message_error == 0 ? int(n) : 0);
        finished.push_back(std::move(urb));
        listening.pop_front();
    }
}

}  // namespace eventide::testing_support
