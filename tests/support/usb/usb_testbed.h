// A USB bus that exists only for this process and its children, with software cameras plugged into
// it (umockdev).
#pragma once

#include "tests/support/usb/usb_descriptors.h"
#include "tests/support/usb/usb_model.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace eventide::testing_support {

/// A bus with a place for one camera, and for more where there are several of these. The camera may
/// be plugged in and out at any time from any thread.
class UsbTestbed {
public:
    UsbTestbed();
    /// One more place on the same bus.
    explicit UsbTestbed(UsbTestbed& same_bus);
    ~UsbTestbed();
    UsbTestbed(const UsbTestbed&) = delete;
    UsbTestbed& operator=(const UsbTestbed&) = delete;

    void plug_in(std::shared_ptr<UsbModel> camera, UsbPlace place = {});
    /// As pulling the cable: transfers in flight end, later requests find no device.
    void unplug();
    /// Pulls the cable when so many more requests were made of the device (transfers handed in and
    /// control requests count, looking for finished ones does not). unplug() still has to follow.
    void unplug_after(int requests);
    int requests() const;  ///< since the camera was plugged in

    // Faults of the bus; each lasts until it is set back.

    /// Another program has claimed the camera.
    void give_to_another_program();
    /// The next control requests stall.
    void stall_control(int requests);
    /// Control requests are answered only after somebody looked so many times whether they were;
    /// kNever: never.
    void delay_control(int looks);
    static constexpr int kNever = -1;
    /// The data endpoint halts: the first transfer in flight ends with a stall, and nothing more
    /// comes until the halt is cleared with no transfer in flight. So many times, each as soon as
    /// transfers wait.
    void halt_data(int times);
    /// Data that no program before this one fetched: they come first, unless the endpoint is
    /// cleared.
    void leave_unread(std::vector<std::byte> bytes);
    /// The device sends more than the next so many transfers have room for (babble): what does not
    /// fit is lost.
    void overflow_data(int transfers);
    /// Transfers for messages end with this errno (EPIPE: the endpoint halts); 0: they do not.
    void fail_messages(int error);
    /// At most so many bytes per transfer, to make short packets; 0 for as many as fit.
    void limit_transfer(std::size_t bytes);
    /// Every n-th transfer loses its last byte on the way; 0: none.
    void lose_last_byte_of_every(int transfers);
    /// Transfers beyond so many bytes in flight are refused for want of memory (usbfs_memory_mb).
    void limit_memory(std::size_t bytes);

    /// With the camera's lock held, so that it stands still while you look.
    void look(const std::function<void()>& at);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace eventide::testing_support
