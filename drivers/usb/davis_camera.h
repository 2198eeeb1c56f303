// A DAVIS on USB as a source: open, configure, start, stream, survive being unplugged.
#pragma once

#include "drivers/camera.h"
#include "drivers/usb/davis_exposure.h"
#include "drivers/usb/davis_settings.h"
#include "drivers/usb/usb_device.h"
#include "drivers/usb/usb_stream.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace eventide {

/// Every DAVIS on the bus, with what keeps it from being used.
std::vector<CameraDescription> list_davis_cameras();

/// USB products that carry a DAVIS: behind FX2 and behind FX3.
inline constexpr std::uint16_t kDavisFx2 = 0x841B, kDavisFx3 = 0x841A;

/// What the camera needs between the steps of a start (drivers-and-formats.md A.8): the device's
/// waits, not ours. A camera in software needs none.
struct DavisWaits {
    std::chrono::milliseconds idle{10}, biases_settle{200}, flow_settles{50};
};

struct DavisOptions {
    std::string serial;          ///< empty: the first camera found
    int bus = -1, address = -1;  ///< -1: any
    DavisSettings settings;
    bool reconnect = false;  ///< wait for the camera to come back instead of ending with an error
    DavisWaits waits;
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
    void reset_timestamps();
    bool wait_for_reset_marker();
    ReadStatus read_stream(RawPacket& into);
    void adjust_exposure();
    void leave_out_half_word(std::vector<std::byte>& bytes);
    void stop_device() noexcept;
    void close();
    ReadStatus lost();
    ReadStatus wait_for_return();

    DavisOptions options_;
    SensorInfo info_;
    DavisSensor sensor_;
    DavisFeatures features_;
    CameraCounters counters_;
    std::unique_ptr<UsbDevice> device_;
    std::unique_ptr<UsbStream> stream_;            ///< after device_: it must end first
    std::optional<std::vector<std::byte>> first_;  ///< bytes that came with the reset marker
    std::shared_ptr<ExposureWish> exposure_wish_ = std::make_shared<ExposureWish>(0);
    std::uint64_t dropped_before_ = 0;  ///< the device's counter when it was started
    bool gap_ = false;
    std::atomic<bool> stopped_{false};
};

}  // namespace eventide
