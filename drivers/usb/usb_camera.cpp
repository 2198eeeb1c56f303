#include "drivers/usb/usb_camera.h"

#include "src/core/error.h"

#include <thread>
#include <utility>

namespace eventide {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kLogicWanted = 18;
constexpr std::uint8_t kSecondGenerationBoard = 5;
constexpr auto kReadTimeout = 20ms;
constexpr auto kBeginTimeout = 1000ms;
constexpr auto kDropsEvery = 1s;

}  // namespace

UsbCamera::UsbCamera(UsbKind kind, UsbCameraOptions options, UsbStreamSettings transfers)
    : kind_(std::move(kind)),
      options_(std::move(options)),
      warnings_(options_.warn),
      transfers_(transfers) {
    selector_.name = kind_.name;
    selector_.products = kind_.products;
    selector_.serial = options_.serial;
    selector_.bus = options_.bus;
    selector_.address = options_.address;
}

void UsbCamera::refuse(const std::string& why) const {
    throw Error(ErrorKind::device,
                std::string{"the "} + kind_.name + " '" + info_.serial + "' " + why);
}

void UsbCamera::require_firmware(const UsbIdentity& identity, int oldest) const {
    if (identity.board_type == kSecondGenerationBoard)
        refuse("is a second-generation board (type 5): its protocol is not supported");
    if (identity.firmware < oldest)
        refuse("has firmware " + std::to_string(identity.firmware) + ", at least " +
               std::to_string(oldest) + " is needed: update it with iniVation's DV or Flashy");
}

void UsbCamera::require_logic(UsbDevice& device, std::uint32_t oldest_patch) {
    const std::uint32_t logic = device.read_register(davis::kLogicVersion),
                        patch = device.read_register(davis::kLogicPatch);
    logic_ = std::to_string(logic) + " patch " + std::to_string(patch);
    if (logic == kLogicWanted && patch >= oldest_patch) return;
    refuse("has FPGA logic version " + logic_ + ", expected 18 patch " +
           std::to_string(oldest_patch) + " or later: " +
           (logic > kLogicWanted
                ? "newer generations speak another protocol, which is not supported"
                : "update it with iniVation's DV or Flashy"));
}

void UsbCamera::open() {
    const bool first = info_.width == 0;
    SensorInfo info;
    const auto set_up_device = [&](UsbDevice& device) {
        if (first) info_.serial = device.identity().serial;  // for what set_up() may have to say
        info = set_up(device);
    };
    device_ = UsbDevice::open(selector_, set_up_device, options_.warn);
    const UsbIdentity& identity = device_->identity();
    if (first) {  // others may read it from then on
        info.serial = identity.serial;
        info_ = std::move(info);
        expect_return_of(identity);
    }
}

std::size_t UsbCamera::packet_bytes() const {
    return device_ ? fitting(transfers_, device_->identity().superspeed).bytes : 0;
}

void UsbCamera::start() {
    drops_are_told_ = true;
    dropped_until_now_ = drops_so_far().value_or(0);
    look_at_drops_ = std::chrono::steady_clock::now() + kDropsEvery;
    make_idle(*device_);
    std::this_thread::sleep_for(options_.waits.idle);
    device_->clear_halt(kind_.data_endpoint);
    stream_ = std::make_unique<UsbStream>(device_->context(), device_->handle(),
                                          UsbEndpoints{kind_.data_endpoint, message_endpoint()},
                                          fitting(transfers_, device_->identity().superspeed));
    start_data(*device_);
    reset_time(*device_);
    if (!wait_for_begin() && !stopped_)
        refuse(
            "was started but no data came within a second: plug it in again, and if it is behind "
            "a hub, try a port of the computer");
}

/// Words from after the reset prove that data really flow; what came before is from another time
/// and is left out.
bool UsbCamera::wait_for_begin() {
    const auto deadline = std::chrono::steady_clock::now() + kBeginTimeout;
    std::vector<std::byte> bytes;
    while (!stopped_ && std::chrono::steady_clock::now() < deadline) {
        const UsbStream::Status status = stream_->read(bytes, kReadTimeout);
        if (status == UsbStream::Status::lost)
            throw UsbDisconnected("USB: the camera was unplugged");
        if (const auto halts = stream_->take_halts(); halts > 0) {
            count(CameraCount::stalls, halts);
            reset_time(*device_);  // the begin may be lost with them
        }
        if (status != UsbStream::Status::data) continue;
        if (const auto begin = find_begin(bytes)) {
            first_.emplace(bytes.begin() + std::ptrdiff_t(*begin), bytes.end());
            return true;
        }
    }
    return false;
}

ReadStatus UsbCamera::read(RawPacket& into) {
    into.bytes.clear();
    if (!stopped_ && !device_) return wait_for_return();
    const bool was_streaming = stream_ != nullptr;
    try {
        if (!stopped_ && !stream_) start();
        if (stopped_) {
            stop_device();
            return ReadStatus::end;
        }
        between_transfers(*device_);
        look_at_drops();
        return read_stream(into);
    } catch (const UsbDisconnected&) {
        into.bytes.clear();
        return lost();
    } catch (const Error& error) {  // it is there, and may work once it was opened again
        if (!options_.reconnect || !was_streaming) throw;
        into.bytes.clear();
        leave([this] { stop_device(); });
        warnings_.tell(error);
        return ReadStatus::timeout;
    }
}

ReadStatus UsbCamera::read_stream(RawPacket& into) {
    if (first_) {
        into.bytes.swap(*first_);
        first_.reset();
    } else {
        switch (stream_->read(into.bytes, kReadTimeout)) {
            case UsbStream::Status::lost:
                throw UsbDisconnected("USB: the camera was unplugged");
            case UsbStream::Status::timeout:
                into.bytes.clear();
                return ReadStatus::timeout;
            case UsbStream::Status::message:
                frame_message(into.bytes);
                break;
            case UsbStream::Status::data:
                gap_ = gap_ || stream_->gap_before();
        }
        count(CameraCount::stalls, stream_->take_halts());
    }
    into.arrived = std::chrono::steady_clock::now();
    into.gap_before = std::exchange(gap_, false);
    into.reopened = std::exchange(reopened_, false);
    count(CameraCount::transfers);
    count(CameraCount::bytes, into.bytes.size());
    leave_out_half_word(into.bytes);
    return ReadStatus::data;
}

/// Transfers hold whole packets and packets whole words: where half a word ends one, the rest of it
/// is lost, and the next begins with a whole word (as libcaer sees it, too).
void UsbCamera::leave_out_half_word(std::vector<std::byte>& bytes) {
    const std::size_t half = bytes.size() % word_bytes();
    if (half == 0) return;
    bytes.resize(bytes.size() - half);
    count(CameraCount::cut_transfers);
    gap_ = true;
}

/// Empty where the camera refuses to tell; it is not asked again then.
std::optional<std::uint64_t> UsbCamera::drops_so_far() {
    try {
        return dropped(*device_);
    } catch (const UsbDisconnected&) {
        throw;
    } catch (const Error& error) {
        drops_are_told_ = false;
        if (options_.warn)
            options_.warn(std::string{"the "} + kind_.name + " '" + info_.serial +
                          "' does not tell how many events it drops: " + error.what());
        return std::nullopt;
    }
}

/// Between transfers: the requests are short, but a camera that does not answer them would hold up
/// the stream each time.
void UsbCamera::look_at_drops() {
    const auto now = std::chrono::steady_clock::now();
    if (!drops_are_told_ || now < look_at_drops_) return;
    look_at_drops_ = now + kDropsEvery;
    const auto dropped = drops_so_far();
    if (!dropped) return;
    // Less than before: the logic began to count anew.
    count(CameraCount::dropped_events,
          *dropped - (*dropped < dropped_until_now_ ? 0 : dropped_until_now_));
    dropped_until_now_ = *dropped;
}

void UsbCamera::close() {
    first_.reset();
    stream_.reset();
    device_.reset();
}

/// A waiting read() looks at this within kReadTimeout.
void UsbCamera::stop() noexcept {
    stopped_ = true;
}

void UsbCamera::stop_device() noexcept {
    if (!device_) return;
    try {
        if (stream_) {
            look_at_drops_ = {};  // for the last time
            look_at_drops();
            make_idle(*device_);
        }
        power_down(*device_);
    } catch (const Error&) {
        // Unplugged meanwhile: there is nothing left to stop.
    }
    close();
}

}  // namespace eventide
