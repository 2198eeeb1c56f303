// A DVXplorer on USB as a source: behind FX3 (the "red" board) or CX3 (Mini, Micro).
#pragma once

#include "drivers/usb/dvxplorer_settings.h"
#include "drivers/usb/usb_camera.h"

#include <memory>
#include <vector>

namespace eventide {

struct DvxplorerOptions : UsbCameraOptions {
    DvxplorerSettings settings;
};

/// Every DVXplorer on the bus, with what keeps it from being used.
std::vector<CameraDescription> list_dvxplorer_cameras();

class DvxplorerCamera final : public UsbCamera {
public:
    /// Opens and configures. Throws Error (device): no camera, no permission, in use, firmware or
    /// logic that does not fit, a second-generation board, a setting that was not taken.
    explicit DvxplorerCamera(const DvxplorerOptions& options);
    ~DvxplorerCamera() override;

    std::unique_ptr<Parser> make_parser() const override;
    const DvxplorerSensor& sensor() const { return sensor_; }

private:
    SensorInfo set_up(UsbDevice& device) override;
    void make_idle(UsbDevice& device) override;
    void start_data(UsbDevice& device) override;
    void reset_time(UsbDevice& device) override;
    std::optional<std::size_t> find_begin(std::span<const std::byte> bytes) const override;
    std::size_t word_bytes() const override { return features_.mini ? 4 : 2; }
    void power_down(UsbDevice& device) override;
    std::uint64_t dropped(UsbDevice& device) override;
    std::uint8_t message_endpoint() const override;
    void frame_message(std::vector<std::byte>& message) const override;
    void power_up(UsbDevice& device);
    SensorInfo configure(UsbDevice& device);
    void power_down_after_failure(UsbDevice& device) noexcept;
    DvxplorerSensor read_sensor(UsbDevice& device);

    DvxplorerSettings settings_;
    DvxplorerSensor sensor_;
    DvxplorerFeatures features_;
};

}  // namespace eventide
