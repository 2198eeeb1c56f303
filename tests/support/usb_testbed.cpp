#include "tests/support/usb_testbed.h"

#include "tests/support/glib_owned.h"
#include "tests/support/preload.h"

#include <sys/ioctl.h>

#include <linux/usbdevice_fs.h>
#include <umockdev.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <deque>
#include <stdexcept>
#include <string>

namespace eventide::testing_support {
namespace {

constexpr const char* kSysfsPath = "/sys/devices/usb1";
constexpr const char* kNode = "/dev/bus/usb/001/001";
constexpr std::uint8_t kDataEndpoint = 0x82;
constexpr std::uint8_t kSerialString = 3;

std::string hex(std::span<const std::uint8_t> bytes) {
    std::string text;
    for (const std::uint8_t b : bytes) {
        std::array<char, 3> digits{};
        std::snprintf(digits.data(), digits.size(), "%02X", unsigned(b));
        text += digits.data();
    }
    return text;
}

/// Device, configuration, interface, bulk IN 0x82, interrupt IN 0x81.
std::string descriptors(const DavisModelSettings& camera) {
    const std::array<std::uint8_t, 50> bytes{18,
                                             1,
                                             0x00,
                                             0x02,
                                             0,
                                             0,
                                             0,
                                             64,
                                             0x2A,
                                             0x15,
                                             std::uint8_t(camera.product & 0xFF),
                                             std::uint8_t(camera.product >> 8),
                                             camera.firmware,
                                             camera.board_type,
                                             1,
                                             2,
                                             kSerialString,
                                             1,  //
                                             9,
                                             2,
                                             32,
                                             0,
                                             1,
                                             1,
                                             0,
                                             0x80,
                                             250,  //
                                             9,
                                             4,
                                             0,
                                             0,
                                             2,
                                             0xFF,
                                             0,
                                             0,
                                             0,  //
                                             7,
                                             5,
                                             kDataEndpoint,
                                             2,
                                             0x00,
                                             0x02,
                                             0,  //
                                             7,
                                             5,
                                             0x81,
                                             3,
                                             64,
                                             0,
                                             8};
    return hex(bytes);
}

std::string device_record(const DavisModelSettings& camera) {
    return "P: /devices/usb1\n"
           "N: bus/usb/001/001\n"
           "E: BUSNUM=001\nE: DEVNUM=001\nE: DEVNAME=/dev/bus/usb/001/001\n"
           "E: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: MAJOR=189\nE: MINOR=0\n"
           "A: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum=1\\n\nA: speed=5000\\n\n"
           "H: descriptors=" +
           descriptors(camera) + "\n";
}

std::uint16_t little16(const std::uint8_t* at) {
    return std::uint16_t(at[0] | (at[1] << 8));
}
std::uint32_t big32(const std::uint8_t* at) {
    return (std::uint32_t(at[0]) << 24) | (std::uint32_t(at[1]) << 16) |
           (std::uint32_t(at[2]) << 8) | at[3];
}

}  // namespace

struct UsbTestbed::Parts {
    Owned<UMockdevTestbed> testbed;
    Owned<UMockdevIoctlBase> handler;
    std::mutex mutex;  // for all below: requests come on umockdev's thread
    std::shared_ptr<DavisModel> camera;
    bool attached = false, gone = true;
    struct Urb {
        Owned<UMockdevIoctlData> urb, buffer;
        usbdevfs_urb* fields() const { return reinterpret_cast<usbdevfs_urb*>(urb->data); }
    };
    std::deque<Urb> waiting, finished;
    int stalls = 0;
    std::size_t limit = 0;

    static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer parts) {
        return static_cast<Parts*>(parts)->handle(client);
    }
    gboolean handle(UMockdevIoctlClient* client);
    int submit(UMockdevIoctlData* arg);
    bool reap(UMockdevIoctlData* arg);
    int discard(UMockdevIoctlData* arg);
    void control(Urb& urb);
    int answer(const std::uint8_t* setup, std::uint8_t* data, int length);
    void fill_transfers();
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

void UsbTestbed::plug_in(std::shared_ptr<DavisModel> camera) {
    {
        const std::lock_guard lock{parts_->mutex};
        parts_->camera = std::move(camera);
        parts_->gone = false;
    }
    GError* error = nullptr;
    const std::string record = device_record(parts_->camera->settings());
    if (!umockdev_testbed_add_from_string(parts_->testbed.get(), record.c_str(), &error) ||
        !umockdev_testbed_attach_ioctl(parts_->testbed.get(), kNode, parts_->handler.get(),
                                       &error)) {
        const Owned<GError> owned{error};
        throw std::runtime_error(std::string{"umockdev: "} + owned->message);
    }
    parts_->attached = true;
    umockdev_testbed_uevent(parts_->testbed.get(), kSysfsPath, "add");
}

void UsbTestbed::unplug() {
    if (!parts_->attached) return;
    {
        const std::lock_guard lock{parts_->mutex};
        parts_->gone = true;
        for (auto& urb : parts_->waiting) {
            urb.fields()->status = -ESHUTDOWN;
            urb.fields()->actual_length = 0;
            parts_->finished.push_back(std::move(urb));
        }
        parts_->waiting.clear();
    }
    umockdev_testbed_uevent(parts_->testbed.get(), kSysfsPath, "remove");
    umockdev_testbed_detach_ioctl(parts_->testbed.get(), kNode, nullptr);
    umockdev_testbed_remove_device(parts_->testbed.get(), kSysfsPath);
    parts_->attached = false;
}

void UsbTestbed::stall_control(int requests) {
    const std::lock_guard lock{parts_->mutex};
    parts_->stalls = requests;
}

void UsbTestbed::limit_transfer(std::size_t bytes) {
    const std::lock_guard lock{parts_->mutex};
    parts_->limit = bytes;
}

void UsbTestbed::look(const std::function<void(DavisModel&)>& at) {
    const std::lock_guard lock{parts_->mutex};
    at(*parts_->camera);
}

gboolean UsbTestbed::Parts::handle(UMockdevIoctlClient* client) {
    const std::lock_guard lock{mutex};
    UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
    const auto complete = [&](long result, int error) {
        umockdev_ioctl_client_complete(client, result, error);
        return TRUE;
    };
    const auto request = umockdev_ioctl_client_get_request(client);
    // What is finished may still be fetched after the cable was pulled.
    if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) {
        if (reap(arg)) return complete(0, 0);
        return complete(-1, gone ? ENODEV : EAGAIN);
    }
    if (gone) return complete(-1, ENODEV);
    switch (request) {
        case USBDEVFS_GET_CAPABILITIES: {
            const Owned<UMockdevIoctlData> caps{
                umockdev_ioctl_data_resolve(arg, 0, sizeof(guint32), nullptr)};
            const guint32 value = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                  USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
            std::memcpy(caps->data, &value, sizeof value);
            return complete(0, 0);
        }
        case USBDEVFS_CLEAR_HALT:
            camera->clear_endpoint();
            return complete(0, 0);
        case USBDEVFS_CLAIMINTERFACE:
        case USBDEVFS_RELEASEINTERFACE:
        case USBDEVFS_SETCONFIGURATION:
        case USBDEVFS_SETINTERFACE:
        case USBDEVFS_RESET:
            return complete(0, 0);
        case USBDEVFS_GETDRIVER:
            return complete(-1, ENODATA);
        case USBDEVFS_SUBMITURB: {
            const int error = submit(arg);
            return complete(error == 0 ? 0 : -1, error);
        }
        case USBDEVFS_DISCARDURB: {
            const int error = discard(arg);
            return complete(error == 0 ? 0 : -1, error);
        }
        default:
            return complete(-1, ENOTTY);
    }
}

int UsbTestbed::Parts::submit(UMockdevIoctlData* arg) {
    Urb urb;
    urb.urb.reset(umockdev_ioctl_data_resolve(arg, 0, sizeof(usbdevfs_urb), nullptr));
    if (!urb.urb) return EFAULT;
    urb.buffer.reset(umockdev_ioctl_data_resolve(urb.urb.get(), offsetof(usbdevfs_urb, buffer),
                                                 gsize(urb.fields()->buffer_length), nullptr));
    if (!urb.buffer) return EFAULT;
    if (urb.fields()->type == USBDEVFS_URB_TYPE_CONTROL) {
        control(urb);
        finished.push_back(std::move(urb));
    } else {
        waiting.push_back(std::move(urb));
    }
    return 0;
}

void UsbTestbed::Parts::control(Urb& urb) {
    constexpr int kSetupBytes = 8;
    usbdevfs_urb& fields = *urb.fields();
    if (stalls > 0) {
        --stalls;
        fields.status = -EPIPE;
        return;
    }
    const int n = answer(urb.buffer->data, urb.buffer->data + kSetupBytes,
                         fields.buffer_length - kSetupBytes);
    fields.status = n < 0 ? -EPIPE : 0;
    fields.actual_length = std::max(n, 0);
}

/// Bytes transferred, or -1 for a request the camera does not know.
int UsbTestbed::Parts::answer(const std::uint8_t* setup, std::uint8_t* data, int length) {
    const std::uint8_t type = setup[0], request = setup[1];
    const std::uint16_t value = little16(setup + 2), index = little16(setup + 4);
    if (type == 0x80 && request == 6 && (value >> 8) == 3) {  // GET_DESCRIPTOR, string
        std::vector<std::uint8_t> text{0, 3};
        if ((value & 0xFF) == 0) {
            text.insert(text.end(), {0x09, 0x04});
        } else {
            const std::string words =
                (value & 0xFF) == kSerialString ? camera->settings().serial : "DAVIS";
            for (const char c : words) text.insert(text.end(), {std::uint8_t(c), 0});
        }
        text[0] = std::uint8_t(text.size());
        const int n = std::min(length, int(text.size()));
        std::copy_n(text.begin(), n, data);
        return n;
    }
    if (request == 0xBF && type == 0xC0 && length >= 4) {
        const std::uint32_t number = camera->read({value, index});
        for (int i = 0; i < 4; ++i) data[i] = std::uint8_t(number >> (24 - 8 * i));
        return 4;
    }
    if (request == 0xBF && type == 0x40 && length == 4) {
        camera->write({{value, index}, big32(data)});
        return 4;
    }
    if (request == 0xC2 && type == 0x40 && length == 6 * value) {
        for (int i = 0; i < value; ++i)
            camera->write({{data[6 * i], data[6 * i + 1]}, big32(data + 6 * i + 2)});
        return length;
    }
    return -1;
}

/// Bulk requests are answered in order, when the camera has something to say.
void UsbTestbed::Parts::fill_transfers() {
    while (!waiting.empty()) {
        Urb& urb = waiting.front();
        if (urb.fields()->endpoint != kDataEndpoint) return;
        std::size_t room = std::size_t(urb.fields()->buffer_length);
        if (limit != 0) room = std::min(room, limit);
        const std::size_t n = camera->send({reinterpret_cast<std::byte*>(urb.buffer->data), room});
        if (n == 0) return;
        urb.fields()->status = 0;
        urb.fields()->actual_length = int(n);
        finished.push_back(std::move(urb));
        waiting.pop_front();
    }
}

bool UsbTestbed::Parts::reap(UMockdevIoctlData* arg) {
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
    const auto found = std::find_if(waiting.begin(), waiting.end(), [&](const Urb& urb) {
        return urb.urb->client_addr == address;
    });
    if (found == waiting.end()) return EINVAL;
    found->fields()->status = -ENOENT;
    found->fields()->actual_length = 0;
    finished.push_back(std::move(*found));
    waiting.erase(found);
    return 0;
}

}  // namespace eventide::testing_support
