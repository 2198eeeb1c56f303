#include "drivers/usb/davis_camera.h"

#include "drivers/usb/verified_writes.h"
#include "src/codec/inivation/davis.h"
#include "src/core/bayer.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"

#include <algorithm>
#include <array>
#include <string>
#include <thread>
#include <utility>

namespace eventide {
namespace {

using namespace davis;

constexpr int kFirmwareFx2 = 4, kFirmwareFx3 = 6;
constexpr std::uint32_t kPatch = 1;
constexpr int kMaxRefusals = 3;  // in a row, of an exposure

UsbKind kind() {
    return {"DAVIS", "davis:", {kDavisFx3, kDavisFx2}};
}

const char* chip_name(std::uint32_t chip_id) {
    switch (chip_id > UINT8_MAX ? DavisChip{UINT8_MAX} : DavisChip(chip_id)) {
        case DavisChip::davis240a:
            return "DAVIS240A";
        case DavisChip::davis240b:
            return "DAVIS240B";
        case DavisChip::davis240c:
            return "DAVIS240C";
        case DavisChip::davis128:
            return "DAVIS128";
        case DavisChip::davis346a:
            return "DAVIS346A";
        case DavisChip::davis346b:
            return "DAVIS346B";
        case DavisChip::davis640:
            return "DAVIS640";
        case DavisChip::davis640h:
            return "DAVIS640H";
        case DavisChip::davis208:
            return "DAVIS208";
        case DavisChip::davis346c:
            return "DAVIS346C";
    }
    return "unknown";
}

/// The others have other biases, or read their frames in another order.
bool is_supported(std::uint32_t chip_id) {
    constexpr std::array kSupported{DavisChip::davis240a, DavisChip::davis240b,
                                    DavisChip::davis240c, DavisChip::davis346a,
                                    DavisChip::davis346b, DavisChip::davis346c};
    return std::ranges::any_of(kSupported,
                               [&](DavisChip chip) { return std::uint32_t(chip) == chip_id; });
}

}  // namespace

DavisCamera::DavisCamera(const DavisOptions& options)
    : UsbCamera(kind(), options, options.settings.transfers), settings_(options.settings) {
    open();
}

DavisCamera::~DavisCamera() {
    stop_device();
}

SensorInfo DavisCamera::set_up(UsbDevice& device) {
    require_firmware(device.identity(),
                     device.identity().product == kDavisFx2 ? kFirmwareFx2 : kFirmwareFx3);
    require_logic(device, kPatch);
    read_features(device);
    const DavisSensor sensor = read_sensor(device);
    SensorInfo info;
    info.name = chip_name(std::uint32_t(sensor.chip));
    info.format = "davis";
    info.width = sensor.width();
    info.height = sensor.height();
    info.colour_filter = sensor.colour_filter;
    require_same(info, sensor == sensor_);
    sensor_ = sensor;
    refusals_ = 0;
    write_settings(device, configuration(settings_, sensor_, features_), settings_.verify);
    return info;
}

void DavisCamera::read_features(UsbDevice& device) {
    const auto number = [&](Register at) { return int(device.read_register(at)); };
    const auto flag = [&](Register at) { return number(at) != 0; };
    features_.pixel_filter = flag(kDvsHasPixelFilter);
    features_.activity_filter = flag(kDvsHasActivityFilter);
    features_.roi = flag(kDvsHasRoi);
    features_.skip = flag(kDvsHasSkip);
    features_.polarity_filter = flag(kDvsHasPolarityFilter);
    features_.statistics = flag(kMuxHasStatistics);
    features_.global_shutter = flag(kApsHasGlobalShutter);
    features_.generator = flag(kExtHasGenerator);
    features_.logic_mhz = number(kLogicMhz);
    features_.adc_mhz = number(kAdcMhz);
    features_.usb_mhz = number(kUsbMhz);
    features_.deviation = number(kClockDeviation);
}

DavisSensor DavisCamera::read_sensor(UsbDevice& device) const {
    const auto number = [&](Register at) { return int(device.read_register(at)); };
    const std::uint32_t chip_id = device.read_register(kChipId);
    if (!is_supported(chip_id))
        refuse("has chip id " + std::to_string(chip_id) + " (" + chip_name(chip_id) +
               "), expected that of a DAVIS240A, B or C or of a DAVIS346A, B or C");
    DavisSensor sensor;
    sensor.chip = DavisChip(chip_id);
    sensor.dvs_columns = number(kDvsColumns);
    sensor.dvs_rows = number(kDvsRows);
    sensor.dvs_swapped = (number(kDvsOrientation) & 4) != 0;
    sensor.aps_columns = number(kApsColumns);
    sensor.aps_rows = number(kApsRows);
    const int aps = number(kApsOrientation);
    sensor.aps_swapped = (aps & 4) != 0;
    sensor.colour_filter =
        colour_filter_of_number(device.read_register(kApsColorFilter)).value_or(ColourFilter::none);
    sensor.aps_flip_x = (aps & 2) != 0;
    sensor.aps_flip_y = (aps & 1) != 0;
    sensor.imu_type = number(kImuType);
    const int imu = number(kImuOrientation);
    sensor.imu_flip_x = (imu & 4) != 0;
    sensor.imu_flip_y = (imu & 2) != 0;
    sensor.imu_flip_z = (imu & 1) != 0;
    constexpr int kLargest = 1024;
    for (const int size :
         {sensor.dvs_columns, sensor.dvs_rows, sensor.aps_columns, sensor.aps_rows})
        if (size < 1 || size > kLargest)
            refuse("says its sensor has a side of " + std::to_string(size) +
                   " px, expected 1 to 1024");
    return sensor;
}

void DavisCamera::make_idle(UsbDevice& device) {
    device.write_registers(idle_writes());
}

void DavisCamera::start_data(UsbDevice& device) {
    device.write_register({kRunChip, 1});
    std::this_thread::sleep_for(waits().biases_settle);
    device.write_registers(flow_writes());
    std::this_thread::sleep_for(waits().flow_settles);
    device.write_registers(run_writes(settings_));
}

void DavisCamera::reset_time(UsbDevice& device) {
    const Write reset[] = {{kTimestampReset, 1}, {kTimestampReset, 0}};
    device.write_together(reset);
}

std::optional<std::size_t> DavisCamera::find_begin(std::span<const std::byte> bytes) const {
    constexpr std::uint16_t kResetMarker = 1;
    for (std::size_t at = 0; at + 2 <= bytes.size(); at += 2)
        if (load_little<std::uint16_t>(&bytes[at]) == kResetMarker) return at;
    return std::nullopt;
}

std::uint64_t DavisCamera::dropped(UsbDevice& device) {
    return features_.statistics ? device.read_counter(kMuxDroppedDvs) : 0;
}

std::unique_ptr<Parser> DavisCamera::make_parser() const {
    // Of several parsers (the pipeline's, the recorder's) one at a time adjusts the exposure.
    const bool nobody_adjusts = exposure_request_.use_count() == 1;
    if (!settings_.auto_exposure || !settings_.frames || !nobody_adjusts)
        return std::make_unique<DavisParser>(sensor_);
    return std::make_unique<ExposingDavisParser>(sensor_, settings_.exposure_us, exposure_request_);
}

/// On the source thread: a control request inside event handling would wait for itself. One that
/// fails is no reason to end: the frames go on with the exposure they have, and it is tried again.
void DavisCamera::between_transfers(UsbDevice& device) {
    const int wanted_us = exposure_request_->exchange(0, std::memory_order_relaxed);
    if (wanted_us <= 0) return;
    settings_.exposure_us = wanted_us;  // also where the camera has to be opened again
    try {
        device.write_register({kApsExposure, adc_cycles(wanted_us, features_)});
        refusals_ = 0;
    } catch (const UsbDisconnected&) {
        throw;
    } catch (const Error&) {
        if (++refusals_ == kMaxRefusals) throw;
        int nothing = 0;  // unless a newer one is waiting
        exposure_request_->compare_exchange_strong(nothing, wanted_us, std::memory_order_relaxed);
    }
}

std::vector<CameraDescription> list_davis_cameras() {
    return list_usb_cameras(kind(), [](const UsbCameraOptions& which) {
        DavisOptions options;
        static_cast<UsbCameraOptions&>(options) = which;
        return std::make_unique<DavisCamera>(std::move(options));
    });
}

}  // namespace eventide
