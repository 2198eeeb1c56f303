// A USB bus that exists only for this process and its children, with software cameras plugged into
// it (umockdev).
#pragma once

#include "tests/support/davis_model.h"

#include <memory>
#include <mutex>
#include <string>

namespace eventide::testing_support {

/// One bus with at most one camera on it. The camera may be plugged in and out at any time from any
/// thread.
class UsbTestbed {
public:
    UsbTestbed();
    ~UsbTestbed();
    UsbTestbed(const UsbTestbed&) = delete;
    UsbTestbed& operator=(const UsbTestbed&) = delete;

    void plug_in(std::shared_ptr<DavisModel> camera);
    /// As pulling the cable: transfers in flight end, later requests find no device.
    void unplug();
    /// The next control requests stall.
    void stall_control(int requests);
    /// At most so many bytes per transfer, to make short packets; 0 for as many as fit.
    void limit_transfer(std::size_t bytes);

    /// With the camera's lock held, so that it stands still while you look.
    void look(const std::function<void(DavisModel&)>& at);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace eventide::testing_support
