// What a software USB bus keeps, and how it answers the kernel's requests: shared by
// usb_testbed.cpp (plugging, faults), usb_requests.cpp and usb_transfers.cpp.
#pragma once

#include "tests/support/glib_owned.h"
#include "tests/support/usb/usb_descriptors.h"
#include "tests/support/usb/usb_testbed.h"

#include <linux/usbdevice_fs.h>
#include <umockdev.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace eventide::testing_support {

/// One transfer of the program under test, in its memory.
struct UsbUrb {
    Owned<UMockdevIoctlData> urb, buffer;
    usbdevfs_urb* operator->() const { return reinterpret_cast<usbdevfs_urb*>(urb->data); }
    std::size_t room() const { return std::size_t((*this)->buffer_length); }
    void end(int status, int length = 0) const {
        (*this)->status = status;
        (*this)->actual_length = length;
    }
};

/// What goes wrong; see UsbTestbed.
struct UsbFaults {
    bool claimed = false;  // by another program
    int control_stalls = 0, control_delay = 0, halts = 0, overflows = 0, loses_byte_of_every = 0;
    int unplug_after = -1, message_error = 0;
    std::size_t transfer_limit = 0, memory = SIZE_MAX;
};

struct UsbTestbed::Parts {
    explicit Parts(UMockdevTestbed* bus);

    Owned<UMockdevTestbed> testbed;
    Owned<UMockdevIoctlBase> handler;
    std::mutex mutex;  // for all below: requests come on umockdev's thread
    std::shared_ptr<UsbModel> camera;
    UsbModelIdentity identity;
    UsbPlace place;
    bool attached = false, gone = true, halted = false;
    int requests = 0, looks = 0, transfers = 0;
    std::deque<UsbUrb> controls;                      // not yet answered
    std::deque<UsbUrb> waiting, listening, finished;  // for data, for messages
    std::vector<std::byte> unread;                    // of the device's, from before
    UsbFaults faults;

    /// Below which umockdev keeps its files.
    std::string root() const {
        gchar* const path = umockdev_testbed_get_root_dir(testbed.get());
        const std::string text{path};
        g_free(path);
        return text;
    }
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
    bool discard_from(std::deque<UsbUrb>& urbs, gulong address);
    void answer_controls();
    int control(const UsbUrb& urb);
    void fill_transfers();
    std::size_t send(std::span<std::byte> out);
    bool overflows();
    void tell_messages();
    std::size_t in_flight() const;
};

}  // namespace eventide::testing_support
