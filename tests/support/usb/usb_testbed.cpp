#include "tests/support/usb/usb_testbed.h"

#include "tests/support/preload.h"
#include "tests/support/usb/usb_testbed_parts.h"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace eventide::testing_support {

namespace {

UMockdevTestbed* new_bus() {
    if (!runs_in_testbed())
        throw std::runtime_error("the USB testbed needs umockdev's preload library");
    return umockdev_testbed_new();
}

}  // namespace

UsbTestbed::Parts::Parts(UMockdevTestbed* bus) : testbed(bus), handler(umockdev_ioctl_base_new()) {
    g_signal_connect(handler.get(), "handle-ioctl", G_CALLBACK(&Parts::on_ioctl), this);
}

UsbTestbed::UsbTestbed() : parts_(std::make_unique<Parts>(new_bus())) {}

UsbTestbed::UsbTestbed(UsbTestbed& same_bus)
    : parts_(std::make_unique<Parts>(
          static_cast<UMockdevTestbed*>(g_object_ref(same_bus.parts_->testbed.get())))) {}

UsbTestbed::~UsbTestbed() {
    unplug();
    // What the last request wrote is seen before it is destroyed, by ThreadSanitizer too, which
    // does not know how umockdev ends its threads.
    const std::lock_guard lock{parts_->mutex};
}

// ---- plugging ----------------------------------------------------------------------------------

void UsbTestbed::plug_in(std::shared_ptr<UsbModel> camera, UsbPlace place) {
    Parts& p = *parts_;
    {
        const std::lock_guard lock{p.mutex};
        p.camera = std::move(camera);
        p.identity = p.camera->identity();
        p.place = place;
        p.gone = p.halted = false;
        p.requests = p.looks = p.transfers = 0;
    }
    GError* error = nullptr;
    const std::string record = device_record(p.identity, place), node = device_node(place);
    // In this order, as a program may look for its camera at any time: umockdev ends one that opens
    // a node behind which nobody listens yet.
    if (!umockdev_testbed_attach_ioctl(p.testbed.get(), node.c_str(), p.handler.get(), &error) ||
        !umockdev_testbed_add_from_string(p.testbed.get(), record.c_str(), &error)) {
        const Owned<GError> owned{error};
        throw std::runtime_error(std::string{"umockdev: "} + owned->message);
    }
    p.attached = true;
    umockdev_testbed_uevent(p.testbed.get(), ("/sys" + sysfs_path(place)).c_str(), "add");
}

void UsbTestbed::unplug() {
    Parts& p = *parts_;
    if (!p.attached) return;
    {
        const std::lock_guard lock{p.mutex};
        p.pull_cable();
    }
    const std::string path = "/sys" + sysfs_path(p.place), node = device_node(p.place);
    umockdev_testbed_uevent(p.testbed.get(), path.c_str(), "remove");
    // Nor is there anything to open, or to connect to, once nobody listens any more; the node
    // itself would stay.
    std::error_code none;
    std::filesystem::remove(p.root() + node, none);
    std::filesystem::remove(p.root() + "/ioctl" + node, none);
    umockdev_testbed_detach_ioctl(p.testbed.get(), node.c_str(), nullptr);
    umockdev_testbed_remove_device(p.testbed.get(), path.c_str());
    p.attached = false;
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

void UsbTestbed::give_to_another_program() {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.claimed = true;
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

void UsbTestbed::leave_unread(std::vector<std::byte> bytes) {
    const std::lock_guard lock{parts_->mutex};
    parts_->unread = std::move(bytes);
}

void UsbTestbed::overflow_data(int transfers) {
    const std::lock_guard lock{parts_->mutex};
    parts_->faults.overflows = transfers;
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

}  // namespace eventide::testing_support
