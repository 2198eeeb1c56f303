// A DAVIS on USB as a source: open, configure, start, stream, survive being unplugged.
#pragma once

#include "drivers/camera.h"
#include "drivers/usb/davis_exposure.h"
#include "drivers/usb/davis_settings.h"
#include "drivers/usb/usb_device.h"
#include "drivers/usb/usb_stream.h"

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

namespace eventide {

/// Every DAVIS on the bus, with what keeps it from being used.
std::vector<CameraDescription> list_davis_cameras();

/// USB products that carry a DAVIS: behind FX2 and behind FX3.
inline constexpr std::uint16_t kDavisFx2 = 0x841B, kDavisFx3 = 0x841A;

struct DavisOptions {
    std::string serial;          ///< empty: the first camera found
    int bus = -1, address = -1;  ///< -1: any
    DavisSettings settings;
    bool reconnect = false;  ///< wait for the camera to come back instead of ending with an error
};

class DavisCamera final : public Camera {
public:
    /// Opens and configures. Throws Error (device): no camera, no permission, in use, firmware or
    /// logic that does not fit, a second-generation board; each says what to do.
    explicit DavisCamera(DavisOptions options);
    ~DavisCamera() override;

    const SensorInfo& info() const override { return info_; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override;
    std::unique_ptr<Parser> make_parser() const override;
    CameraCounters counters() const override { return counters_; }

    const DavisSensor& sensor() const { return sensor_; }

private:
    void open();
    void read_sensor();
    void start();
    void adjust_exposure();
    void stop_device() noexcept;
    bool wait_for_reset_marker();
    ReadStatus lost(RawPacket& into);
    bool try_reopen();

    DavisOptions options_;
    SensorInfo info_;
    DavisSensor sensor_;
    DavisFeatures features_;
    CameraCounters counters_;
    std::unique_ptr<UsbDevice> device_;
    std::unique_ptr<UsbStream> stream_;            ///< after device_: it must end first
    std::optional<std::vector<std::byte>> first_;  ///< bytes that came with the reset marker
    std::shared_ptr<ExposureWish> exposure_wish_ = std::make_shared<ExposureWish>(0);
    bool gap_ = false;
    std::atomic<bool> stopped_{false};
};

}  // namespace eventide
