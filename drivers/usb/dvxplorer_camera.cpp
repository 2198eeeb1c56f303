#include "drivers/usb/dvxplorer_camera.h"

#include "drivers/usb/verified_writes.h"
#include "src/codec/inivation/dvxplorer.h"
#include "src/codec/inivation/dvxplorer_mini.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"

#include <string>
#include <thread>
#include <utility>

namespace eventide {
namespace {

using namespace davis;

constexpr int kFirmware = 8, kSecondGeneration = 10;
constexpr std::uint32_t kPatch = 2;
constexpr std::uint8_t kCx3Board = 4;
constexpr std::uint32_t kLiteChip = 19;

UsbKind kind() {
    return {"DVXplorer", "dvxplorer:", {0x8419}};
}

}  // namespace

DvxplorerCamera::DvxplorerCamera(const DvxplorerOptions& options)
    : UsbCamera(kind(), options, options.settings.transfers), settings_(options.settings) {
    open();
}

DvxplorerCamera::~DvxplorerCamera() {
    stop_device();
}

SensorInfo DvxplorerCamera::set_up(UsbDevice& device) {
    require_firmware(device.identity(), kFirmware);
    // A CX3 board keeps its type with it, and refuses every request for a register.
    if (device.identity().firmware >= kSecondGeneration)
        refuse("has firmware " + std::to_string(device.identity().firmware) +
               ", iniVation's second generation, which cannot be taken back: its protocol is not "
               "supported");
    require_logic(device, kPatch);
    features_.mini = device.identity().board_type == kCx3Board;
    features_.lite = device.read_register(kChipId) == kLiteChip;
    try {
        power_up(device);
        return configure(device);
    } catch (const Error&) {
        power_down_after_failure(device);
        throw;
    }
}

/// A Mini does this itself.
void DvxplorerCamera::power_up(UsbDevice& device) {
    if (features_.mini) return;
    device.write_register({kRunChip, 1});
    std::this_thread::sleep_for(waits().idle);
    device.write_registers(chip_writes());
}

SensorInfo DvxplorerCamera::configure(UsbDevice& device) {
    const DvxplorerSensor sensor = read_sensor(device);
    SensorInfo info;
    info.name = features_.mini ? "DVXplorer Mini" : features_.lite ? "DVXplorer Lite" : "DVXplorer";
    info.format = features_.mini ? "dvxplorer-mini" : "dvxplorer";
    info.width = sensor.width;
    info.height = sensor.height;
    require_same(info, sensor == sensor_);
    sensor_ = sensor;
    write_settings(device, configuration(settings_, sensor_, features_), settings_.verify);
    return info;
}

DvxplorerSensor DvxplorerCamera::read_sensor(UsbDevice& device) {
    const auto number = [&](Register at) { return int(device.read_register(at)); };
    const int columns = number(kDvsColumns), rows = number(kDvsRows);
    const int axes = number(kDvsOrientation), imu = number(kImuOrientation);
    constexpr int kLargest = 1024;
    for (const int size : {columns, rows})
        if (size < 1 || size > kLargest)
            refuse("says its sensor has a side of " + std::to_string(size) +
                   " px, expected 1 to 1024");
    DvxplorerSensor sensor;
    sensor.swapped = (axes & 4) != 0;
    sensor.width = sensor.swapped ? rows : columns;
    sensor.height = sensor.swapped ? columns : rows;
    sensor.imu_flip_x = (imu & 4) != 0;
    sensor.imu_flip_y = (imu & 2) != 0;
    sensor.imu_flip_z = (imu & 1) != 0;
    features_.flip_x = (axes & 2) != 0;
    features_.flip_y = (axes & 1) != 0;
    features_.packet_format = device.read_register(dvxplorer::kPacketFormat);
    features_.mode_control = device.read_register(dvxplorer::kModeControl);
    features_.digital_enable = device.read_register(dvxplorer::kDigitalEnable);
    features_.statistics = false;
    if (features_.mini) return sensor;
    features_.statistics = number(kMuxHasStatistics) != 0;
    features_.generator = number(kExtHasGenerator) != 0;
    features_.logic_mhz = number(kLogicMhz);
    features_.usb_mhz = number(kUsbMhz);
    features_.deviation = number(kClockDeviation);
    return sensor;
}

void DvxplorerCamera::make_idle(UsbDevice& device) {
    device.write_registers(dvxplorer_idle_writes(features_.mini));
}

void DvxplorerCamera::start_data(UsbDevice& device) {
    if (!features_.mini) {
        device.write_registers(dvxplorer_flow_writes(false));
        std::this_thread::sleep_for(waits().flow_settles);
    }
    device.write_registers(dvxplorer_run_writes(settings_, features_.mini));
}

/// The chip's clock stamps the words of a Mini, the multiplexer's those of the FX3 board, whose
/// stream also says where that happened.
void DvxplorerCamera::reset_time(UsbDevice& device) {
    device.write_register({dvxplorer::kTimestampReset, 1});
    device.write_register({dvxplorer::kTimestampReset, 0});
    device.write_register({dvxplorer::kMode, dvxplorer::kModeStream});
    const Write reset[] = {{kTimestampReset, 1}, {kTimestampReset, 0}};
    if (!features_.mini) device.write_together(reset);
}

/// FX3: the reset marker. Mini: the first reference time, which comes every millisecond.
std::optional<std::size_t> DvxplorerCamera::find_begin(std::span<const std::byte> bytes) const {
    constexpr std::uint16_t kResetMarker = 1;
    constexpr std::uint32_t kGroupBit = 1U << 31, kReferenceBit = 0x08000000,
                            kColumnBit = 0x04000000;
    const auto begins = [&](std::size_t at) {
        if (!features_.mini) return load_little<std::uint16_t>(&bytes[at]) == kResetMarker;
        const auto w = load_little<std::uint32_t>(&bytes[at]);
        return (w & (kGroupBit | kColumnBit | kReferenceBit)) == kReferenceBit;
    };
    for (std::size_t at = 0; at + word_bytes() <= bytes.size(); at += word_bytes())
        if (begins(at)) return at;
    return std::nullopt;
}

void DvxplorerCamera::power_down(UsbDevice& device) {
    if (!features_.mini) device.write_register({kRunChip, 0});
}

/// A camera that was not opened is not stopped either.
void DvxplorerCamera::power_down_after_failure(UsbDevice& device) noexcept {
    try {
        power_down(device);
    } catch (const Error&) {
        // Unplugged: that is why it failed.
    }
}

std::uint64_t DvxplorerCamera::dropped(UsbDevice& device) {
    return features_.statistics ? device.read_counter(kMuxDroppedDvs) : 0;
}

/// The FX3 board puts IMU samples among its words, a Mini sends them beside.
std::uint8_t DvxplorerCamera::message_endpoint() const {
    constexpr std::uint8_t kMessages = 0x81;
    return features_.mini && settings_.imu ? kMessages : 0;
}

void DvxplorerCamera::frame_message(std::vector<std::byte>& message) const {
    frame_mini_message(message);
}

std::unique_ptr<Parser> DvxplorerCamera::make_parser() const {
    if (features_.mini) return std::make_unique<DvxplorerMiniParser>(sensor_);
    return std::make_unique<DvxplorerParser>(sensor_);
}

std::vector<CameraDescription> list_dvxplorer_cameras() {
    return list_usb_cameras(kind(), [](const UsbCameraOptions& which) {
        DvxplorerOptions options;
        static_cast<UsbCameraOptions&>(options) = which;
        return std::make_unique<DvxplorerCamera>(options);
    });
}

}  // namespace eventide
