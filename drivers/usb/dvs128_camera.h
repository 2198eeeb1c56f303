// A DVS128 on USB as a source. It has no registers: a few requests of its own, and twelve biases.
#pragma once

#include "drivers/usb/usb_camera.h"
#include "drivers/usb/usb_settings.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace eventide {

struct Dvs128Bias {
    const char* name;
    std::uint32_t value;  ///< 24 bits
};
/// In the order in which the camera takes them; libcaer's defaults ("fast").
const std::array<Dvs128Bias, 12>& default_dvs128_biases();

struct Dvs128Settings {
    std::map<std::string, std::uint32_t> biases;  ///< by name, instead of the defaults
    bool master = true;  ///< makes its own time; false: takes it from another camera's cable
    /// It sends packets of 512 bytes, and at most 4 MB a second: small transfers bound the latency
    /// (17 ms at 15,000 events a second, less above), and as many hold 32 ms of it.
    UsbStreamSettings transfers{128, 1024};
};

/// config/cameras/*.toml. Unknown keys and values out of range are refused with file and line
/// (Error, usage).
Dvs128Settings load_dvs128_settings(const std::filesystem::path& file);

/// The bytes of the request that sets the biases: three each, the highest first. Throws Error
/// (usage) for a bias it does not have.
std::vector<std::byte> bias_bytes(const Dvs128Settings& settings);

struct Dvs128Options : UsbCameraOptions {
    Dvs128Settings settings;
};

/// Every DVS128 on the bus, with what keeps it from being used.
std::vector<CameraDescription> list_dvs128_cameras();

class Dvs128Camera final : public UsbCamera {
public:
    /// Opens and configures. Throws Error (device): no camera, no permission, in use, firmware that
    /// is too old.
    explicit Dvs128Camera(const Dvs128Options& options);
    ~Dvs128Camera() override;

    std::unique_ptr<Parser> make_parser() const override;

private:
    SensorInfo set_up(UsbDevice& device) override;
    void make_idle(UsbDevice& device) override;
    void start_data(UsbDevice& device) override;
    void reset_time(UsbDevice& device) override;
    std::optional<std::size_t> find_begin(std::span<const std::byte> bytes) const override;
    std::size_t word_bytes() const override { return 4; }

    Dvs128Settings settings_;
};

}  // namespace eventide
