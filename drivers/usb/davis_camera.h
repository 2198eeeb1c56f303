// A DAVIS on USB as a source.
#pragma once

#include "drivers/usb/davis_exposure.h"
#include "drivers/usb/davis_settings.h"
#include "drivers/usb/usb_camera.h"

#include <memory>
#include <vector>

namespace eventide {

/// Every DAVIS on the bus, with what keeps it from being used.
std::vector<CameraDescription> list_davis_cameras();

/// USB products that carry a DAVIS: behind FX2 and behind FX3.
inline constexpr std::uint16_t kDavisFx2 = 0x841B, kDavisFx3 = 0x841A;

struct DavisOptions : UsbCameraOptions {
    DavisSettings settings;
};

class DavisCamera final : public UsbCamera {
public:
    /// Opens and configures. Throws Error (device): no camera, no permission, in use, firmware or
    /// logic that does not fit, a second-generation board, a chip other than those of the DAVIS240
    /// and DAVIS346, a setting that was not taken; each says what to do.
    explicit DavisCamera(const DavisOptions& options);
    ~DavisCamera() override;

    std::unique_ptr<Parser> make_parser() const override;
    const DavisSensor& sensor() const { return sensor_; }

private:
    SensorInfo set_up(UsbDevice& device) override;
    void make_idle(UsbDevice& device) override;
    void start_data(UsbDevice& device) override;
    void reset_time(UsbDevice& device) override;
    std::optional<std::size_t> find_begin(std::span<const std::byte> bytes) const override;
    std::uint64_t dropped(UsbDevice& device) override;
    void between_transfers(UsbDevice& device) override;
    void read_features(UsbDevice& device);
    DavisSensor read_sensor(UsbDevice& device) const;

    DavisSettings settings_;
    DavisSensor sensor_;
    DavisFeatures features_;
    int refusals_ = 0;  ///< in a row, of an exposure
    std::shared_ptr<ExposureRequest> exposure_request_ = std::make_shared<ExposureRequest>(0);
};

}  // namespace eventide
