#include "drivers/usb/davis_camera.h"

#include "src/codec/davis.h"
#include "src/core/error.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace eventide {
namespace {

using namespace std::chrono_literals;
using namespace davis;

constexpr std::uint8_t kDataEndpoint = 0x82;
constexpr std::uint32_t kLogicWanted = 18;
constexpr int kFirmwareFx2 = 4, kFirmwareFx3 = 6;
constexpr std::uint8_t kSecondGenerationBoard = 5;
constexpr auto kReadPatience = 20ms;
constexpr auto kMarkerPatience = 1000ms;
constexpr std::byte kResetMarker[2] = {std::byte{1}, std::byte{0}};

const char* chip_name(DavisChip chip) {
    switch (chip) {
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
    return "DAVIS";
}

void check_firmware(const UsbIdentity& identity) {
    if (identity.board_type == kSecondGenerationBoard)
        throw Error(ErrorKind::device,
                    "the DAVIS '" + identity.serial +
                        "' is a second-generation board (type 5): its protocol is not supported");
    const int wanted = identity.product == kDavisFx2 ? kFirmwareFx2 : kFirmwareFx3;
    if (identity.firmware < wanted)
        throw Error(ErrorKind::device, "the DAVIS '" + identity.serial + "' has firmware " +
                                           std::to_string(identity.firmware) + ", at least " +
                                           std::to_string(wanted) +
                                           " is needed: update it with iniVation's DV or Flashy");
}

void check_logic(UsbDevice& device) {
    const std::uint32_t logic = device.read_register(kLogicVersion),
                        patch = device.read_register(kLogicPatch);
    if (logic == kLogicWanted && patch >= 1) return;
    throw Error(ErrorKind::device,
                "the DAVIS '" + device.identity().serial + "' has logic " + std::to_string(logic) +
                    " patch " + std::to_string(patch) + ", expected 18 patch 1 or later: " +
                    (logic > kLogicWanted
                         ? "newer generations speak another protocol, which is not supported"
                         : "update it with iniVation's DV or Flashy"));
}

}  // namespace

DavisCamera::DavisCamera(DavisOptions options) : options_(std::move(options)) {
    open();
}

DavisCamera::~DavisCamera() {
    stop_device();
}

void DavisCamera::open() {
    UsbSelector selector;
    selector.products = {kDavisFx3, kDavisFx2};
    selector.serial = options_.serial;
    selector.bus = options_.bus;
    selector.address = options_.address;
    device_ = std::make_unique<UsbDevice>(selector);
    check_firmware(device_->identity());
    check_logic(*device_);
    read_sensor();
    device_->write_registers(configuration(options_.settings, sensor_, features_));
    info_.name = chip_name(sensor_.chip);
    info_.serial = device_->identity().serial;
    info_.format = "davis";
    info_.width = sensor_.width();
    info_.height = sensor_.height();
    options_.serial = info_.serial;  // the same camera must come back, not another
    options_.bus = options_.address = -1;
}

void DavisCamera::read_sensor() {
    const auto number = [&](Register at) { return int(device_->read_register(at)); };
    const auto flag = [&](Register at) { return number(at) != 0; };
    sensor_.chip = DavisChip(number(kChipId));
    features_.pixel_filter = flag(kDvsHasPixelFilter);
    features_.activity_filter = flag(kDvsHasActivityFilter);
    features_.roi = flag(kDvsHasRoi);
    features_.skip = flag(kDvsHasSkip);
    features_.polarity_filter = flag(kDvsHasPolarityFilter);
    features_.statistics = flag(kDvsHasStatistics);
    features_.global_shutter = flag(kApsHasGlobalShutter);
    features_.generator = flag(kExtHasGenerator);
    features_.adc_mhz = number(kAdcMhz);
    features_.usb_mhz = number(kUsbMhz);
    features_.deviation = number(kClockDeviation);
    sensor_.dvs_columns = number(kDvsColumns);
    sensor_.dvs_rows = number(kDvsRows);
    sensor_.dvs_swapped = (number(kDvsOrientation) & 4) != 0;
    sensor_.aps_columns = number(kApsColumns);
    sensor_.aps_rows = number(kApsRows);
    const int aps = number(kApsOrientation);
    sensor_.aps_swapped = (aps & 4) != 0;
    sensor_.aps_flip_x = (aps & 2) != 0;
    sensor_.aps_flip_y = (aps & 1) != 0;
    sensor_.imu_type = number(kImuType);
    const int imu = number(kImuOrientation);
    sensor_.imu_flip_x = (imu & 4) != 0;
    sensor_.imu_flip_y = (imu & 2) != 0;
    sensor_.imu_flip_z = (imu & 1) != 0;
    sensor_.adc_mhz = double(features_.adc_mhz) * features_.deviation / 1000;
    constexpr int kLargest = 1024;
    for (const int size :
         {sensor_.dvs_columns, sensor_.dvs_rows, sensor_.aps_columns, sensor_.aps_rows})
        if (size < 1 || size > kLargest)
            throw Error(ErrorKind::device, "the DAVIS '" + device_->identity().serial +
                                               "' says its sensor has a side of " +
                                               std::to_string(size) + " px, expected 1 to 1024");
}

void DavisCamera::start() {
    if (features_.statistics) dropped_before_ = device_->read_counter(kMuxDroppedDvs);
    device_->write_registers(idle_writes());
    std::this_thread::sleep_for(options_.waits.idle);
    device_->clear_halt(kDataEndpoint);
    stream_ = std::make_unique<UsbStream>(device_->context(), device_->handle(), kDataEndpoint,
                                          options_.settings.transfers);
    device_->write_register({kRunChip, 1});
    std::this_thread::sleep_for(options_.waits.biases_settle);
    device_->write_registers(flow_writes());
    std::this_thread::sleep_for(options_.waits.flow_settles);
    device_->write_registers(run_writes(options_.settings));
    reset_timestamps();
    if (!wait_for_reset_marker() && !stopped_)
        throw Error(ErrorKind::device,
                    "the DAVIS '" + info_.serial +
                        "' was started but no data came within a second: plug it in again, "
                        "and if it is behind a hub, try a port of the computer");
}

void DavisCamera::reset_timestamps() {
    const Write reset[] = {{kTimestampReset, 1}, {kTimestampReset, 0}};
    device_->write_together(reset);
}

/// The marker in the stream proves that data really flow; what came before it is from another time
/// and is left out.
bool DavisCamera::wait_for_reset_marker() {
    const auto deadline = std::chrono::steady_clock::now() + kMarkerPatience;
    std::vector<std::byte> bytes;
    while (!stopped_ && std::chrono::steady_clock::now() < deadline) {
        const UsbStream::Status status = stream_->read(bytes, kReadPatience);
        if (status == UsbStream::Status::lost) throw UsbGone("USB: the camera was unplugged");
        if (const auto halts = stream_->take_halts();
            halts > 0) {  // the marker may be lost with them
            counters_.halts += halts;
            reset_timestamps();
        }
        if (status != UsbStream::Status::data) continue;
        for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
            if (bytes[at] != kResetMarker[0] || bytes[at + 1] != kResetMarker[1]) continue;
            first_.emplace(bytes.begin() + std::ptrdiff_t(at), bytes.end());
            return true;
        }
    }
    return false;
}

ReadStatus DavisCamera::read(RawPacket& into) {
    into.bytes.clear();
    if (!stopped_ && !device_) return wait_for_return();
    try {
        if (!stopped_ && !stream_) start();
        if (stopped_) {
            stop_device();
            return ReadStatus::end;
        }
        adjust_exposure();
        return read_stream(into);
    } catch (const UsbGone&) {
        into.bytes.clear();
        return lost();
    }
}

ReadStatus DavisCamera::read_stream(RawPacket& into) {
    if (first_) {
        into.bytes.swap(*first_);
        first_.reset();
    } else {
        switch (stream_->read(into.bytes, kReadPatience)) {
            case UsbStream::Status::lost:
                throw UsbGone("USB: the camera was unplugged");
            case UsbStream::Status::timeout:
                into.bytes.clear();
                return ReadStatus::timeout;
            case UsbStream::Status::data:
                gap_ = gap_ || stream_->gap_before();
                counters_.halts += stream_->take_halts();
        }
    }
    into.arrived = std::chrono::steady_clock::now();
    into.gap_before = std::exchange(gap_, false);
    ++counters_.transfers;
    counters_.bytes += into.bytes.size();
    leave_out_half_word(into.bytes);
    return ReadStatus::data;
}

/// Transfers hold whole packets and packets whole words: where half a word ends one, the rest of it
/// is lost, and the next begins with a whole word (as libcaer sees it, too).
void DavisCamera::leave_out_half_word(std::vector<std::byte>& bytes) {
    if (bytes.size() % 2 == 0) return;
    bytes.pop_back();
    ++counters_.odd_transfers;
    gap_ = true;
}

/// The camera is gone. Without reconnect that ends the run; with it, silence until it is back.
ReadStatus DavisCamera::lost() {
    close();
    if (!options_.reconnect)
        throw Error(ErrorKind::device,
                    "the DAVIS '" + info_.serial +
                        "' was unplugged (use --reconnect to wait for it to come back)");
    return ReadStatus::timeout;
}

ReadStatus DavisCamera::wait_for_return() {
    if (!options_.reconnect) return lost();
    try {
        open();
        start();
        ++counters_.reconnects;
        gap_ = true;
    } catch (const Error&) {  // not there yet, or not yet ready: the next look will tell
        close();
        std::this_thread::sleep_for(kReadPatience);
    }
    return ReadStatus::timeout;
}

void DavisCamera::close() {
    first_.reset();
    stream_.reset();
    device_.reset();
}

/// A waiting read() looks at this within kReadPatience.
void DavisCamera::stop() noexcept {
    stopped_ = true;
}

void DavisCamera::stop_device() noexcept {
    if (!device_) return;
    try {
        if (stream_) {
            if (features_.statistics)
                counters_.device_dropped += device_->read_counter(kMuxDroppedDvs) - dropped_before_;
            device_->write_registers(idle_writes());
        }
    } catch (const Error&) {
        // Unplugged meanwhile: there is nothing left to stop.
    }
    close();
}

std::unique_ptr<Parser> DavisCamera::make_parser() const {
    // Of several parsers (the line's, the recorder's) one at a time adjusts the exposure.
    const bool nobody_adjusts = exposure_wish_.use_count() == 1;
    if (!options_.settings.auto_exposure || !options_.settings.frames || !nobody_adjusts)
        return std::make_unique<DavisParser>(sensor_);
    return std::make_unique<ExposingDavisParser>(sensor_, options_.settings.exposure_us,
                                                 exposure_wish_);
}

/// Between transfers, on the source thread: a control request inside event handling would wait for
/// itself.
void DavisCamera::adjust_exposure() {
    const int wish_us = exposure_wish_->exchange(0, std::memory_order_relaxed);
    if (wish_us <= 0) return;
    options_.settings.exposure_us = wish_us;  // also where the camera has to be opened again
    device_->write_register({kApsExposure, adc_cycles(wish_us, features_)});
}

namespace {

CameraDescription describe(const UsbIdentity& identity) {
    CameraDescription camera;
    camera.name = "DAVIS";
    camera.serial = identity.serial;
    camera.bus = identity.bus;
    camera.address = identity.address;
    camera.source = "davis:" + (identity.serial.empty() ? std::to_string(identity.bus) + ":" +
                                                              std::to_string(identity.address)
                                                        : identity.serial);
    camera.firmware = std::to_string(identity.firmware);
    camera.problem = identity.problem;
    return camera;
}

}  // namespace

std::vector<CameraDescription> list_davis_cameras() {
    UsbSelector selector;
    selector.products = {kDavisFx3, kDavisFx2};
    std::vector<CameraDescription> cameras;
    for (const UsbIdentity& identity : list_usb_devices(selector)) {
        CameraDescription camera = describe(identity);
        if (camera.problem.empty()) {
            // Chip and logic are known only to the camera itself, so it is opened for a moment.
            DavisOptions options;
            options.bus = identity.bus;
            options.address = identity.address;
            try {
                camera.name = DavisCamera{options}.info().name;
                camera.logic = std::to_string(kLogicWanted);
            } catch (const Error& error) {
                camera.problem = error.what();
            }
        }
        cameras.push_back(std::move(camera));
    }
    return cameras;
}

}  // namespace eventide
