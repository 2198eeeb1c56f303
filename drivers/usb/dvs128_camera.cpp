#include "drivers/usb/dvs128_camera.h"

#include "drivers/settings_file.h"
#include "src/codec/inivation/dvs128.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"

#include <utility>

namespace eventide {
namespace {

// docs/protocols.md A.12, from libcaer's src/dvs128.h.
constexpr std::uint8_t kStart = 0xB3, kStop = 0xB4, kSetBiases = 0xB8, kResetTime = 0xBB,
                       kSetMaster = 0xBE;
constexpr int kFirmware = 14;

UsbKind kind() {
    return {"DVS128", "dvs128:", {0x8400}, 0x86};
}

}  // namespace

const std::array<Dvs128Bias, 12>& default_dvs128_biases() {
    static constexpr std::array<Dvs128Bias, 12> kBiases{{{"cas", 1992},
                                                         {"injGnd", 1108364},
                                                         {"reqPd", 16777215},
                                                         {"puX", 8159221},
                                                         {"diffOff", 132},
                                                         {"req", 309590},
                                                         {"refr", 969},
                                                         {"puY", 16777215},
                                                         {"diffOn", 209996},
                                                         {"diff", 13125},
                                                         {"foll", 271},
                                                         {"pr", 217}}};
    return kBiases;
}

std::vector<std::byte> bias_bytes(const Dvs128Settings& settings) {
    auto wanted = settings.biases;
    std::vector<std::byte> bytes;
    for (const Dvs128Bias& bias : default_dvs128_biases()) {
        const auto own = wanted.extract(bias.name);
        const std::uint32_t value = own.empty() ? bias.value : own.mapped();
        for (const int shift : {16, 8, 0}) bytes.push_back(std::byte((value >> shift) & 0xFF));
    }
    if (!wanted.empty())
        throw Error(ErrorKind::usage,
                    "camera settings: a DVS128 has no bias '" + wanted.begin()->first + "'");
    return bytes;
}

Dvs128Settings load_dvs128_settings(const std::filesystem::path& file) {
    constexpr std::uint32_t kMax24Bits = 0xFFFFFF;
    Dvs128Settings settings;
    read_camera_settings(
        file, {biases_setting(settings.biases, kMax24Bits), flag_setting("master", settings.master),
               transfers_setting(settings.transfers), transfer_size_setting(settings.transfers)});
    return settings;
}

Dvs128Camera::Dvs128Camera(const Dvs128Options& options)
    : UsbCamera(kind(), options, options.settings.transfers), settings_(options.settings) {
    open();
}

Dvs128Camera::~Dvs128Camera() {
    stop_device();
}

/// There is no request that reads anything back.
SensorInfo Dvs128Camera::set_up(UsbDevice& device) {
    require_firmware(device.identity(), kFirmware);
    device.vendor_out(kSetBiases, 0, 0, bias_bytes(settings_));
    device.vendor_out(kSetMaster, settings_.master ? 1 : 0, 0, {});
    SensorInfo info;
    info.name = "DVS128";
    info.format = "dvs128";
    info.width = info.height = 128;
    return info;
}

void Dvs128Camera::make_idle(UsbDevice& device) {
    device.vendor_out(kStop, 0, 0, {});
}

void Dvs128Camera::start_data(UsbDevice& device) {
    device.vendor_out(kStart, 0, 0, {});
}

void Dvs128Camera::reset_time(UsbDevice& device) {
    device.vendor_out(kResetTime, 0, 0, {});
}

/// The reset is a record of its own; a wrap has the bit above it. A slave's time is reset only by
/// its master, over the cable: it leaves out the host's request, and no mark follows.
std::optional<std::size_t> Dvs128Camera::find_begin(std::span<const std::byte> bytes) const {
    constexpr std::uint16_t kWrapBit = 0x8000, kResetBit = 0x4000;
    if (!settings_.master && bytes.size() >= word_bytes()) return 0;
    for (std::size_t at = 0; at + 4 <= bytes.size(); at += 4)
        if ((load_little<std::uint16_t>(&bytes[at + 2]) & (kWrapBit | kResetBit)) == kResetBit)
            return at;
    return std::nullopt;
}

std::unique_ptr<Parser> Dvs128Camera::make_parser() const {
    return std::make_unique<Dvs128Parser>();
}

std::vector<CameraDescription> list_dvs128_cameras() {
    return list_usb_cameras(kind(), [](const UsbCameraOptions& which) {
        Dvs128Options options;
        static_cast<UsbCameraOptions&>(options) = which;
        return std::make_unique<Dvs128Camera>(std::move(options));
    });
}

}  // namespace eventide
