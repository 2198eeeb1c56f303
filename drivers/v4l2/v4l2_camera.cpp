#include "drivers/v4l2/v4l2_camera.h"

#include "drivers/v4l2/v4l2_controls.h"
#include "src/codec/prophesee/evt2.h"
#include "src/codec/prophesee/evt3.h"
#include "src/core/error.h"
#include "src/core/sensor_limits.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <thread>
#include <utility>

namespace eventide {
namespace {

using namespace std::chrono_literals;

/// Users of such boards report poll() that never returns: nothing here waits longer.
constexpr auto kReadTimeout = 20ms;

struct Coding {
    std::uint32_t fourcc;
    EvtEncoding encoding;
    const char* format;
};
// prophesee-ai/linux-sensor-drivers, psee-format.h.
constexpr std::array kCodings{
    Coding{v4l2_fourcc('P', 'S', 'E', 'E'), EvtEncoding::evt2, "evt2"},
    Coding{v4l2_fourcc('P', 'S', 'E', '1'), EvtEncoding::evt21_swapped, "evt21"},
    Coding{v4l2_fourcc('P', 'S', 'E', '2'), EvtEncoding::evt21, "evt21"},
    Coding{v4l2_fourcc('P', 'S', 'E', '3'), EvtEncoding::evt3, "evt3"}};

template <typename Word>
Word word_at(std::span<const std::byte> bytes, std::size_t index) {
    Word word{};
    std::memcpy(&word, bytes.data() + index * sizeof(Word), sizeof(Word));
    return word;
}

/// Bytes before the first word that `ends`, looked for in whole words.
template <typename Word, typename Ends>
std::span<const std::byte> before(std::span<const std::byte> bytes, Ends ends) {
    for (std::size_t i = 0; i < bytes.size() / sizeof(Word); ++i)
        if (ends(word_at<Word>(bytes, i))) return bytes.first(i * sizeof(Word));
    return bytes;
}

const Coding& coding_of(EvtEncoding encoding) {
    return *std::ranges::find(kCodings, encoding, &Coding::encoding);
}

/// "'imx636' with PSE3 of 1280x720 px"
std::string device_text(const SensorInfo& info, std::uint32_t fourcc) {
    return "'" + info.name + "' with " + fourcc_text(fourcc) + " of " + std::to_string(info.width) +
           "x" + std::to_string(info.height) + " px";
}

}  // namespace

std::optional<EvtEncoding> encoding_of(std::uint32_t fourcc) {
    for (const Coding& coding : kCodings)
        if (coding.fourcc == fourcc) return coding.encoding;
    return std::nullopt;
}

std::span<const std::byte> before_end_of_data(std::span<const std::byte> bytes,
                                              EvtEncoding encoding) {
    if (encoding == EvtEncoding::evt3)
        return before<std::uint16_t>(bytes, [](std::uint16_t w) { return w == 0xE019; });
    // The other half of a word is a mask of columns, which may look like anything.
    const int upper_at = encoding == EvtEncoding::evt21_swapped ? 0 : 32;
    return before<std::uint64_t>(
        bytes, [=](std::uint64_t w) { return (w >> upper_at & 0xE00000FFU) == 0xE0000019U; });
}

V4l2Camera::V4l2Camera(std::filesystem::path node, V4l2Settings settings, bool reconnect,
                       std::function<void(const std::string&)> warn)
    : node_(std::move(node)),
      settings_(std::move(settings)),
      reconnect_(reconnect),
      warnings_(std::move(warn)) {
    open();
}

void V4l2Camera::open() {
    if (!settings_.controls.empty()) {
        const auto& holder = settings_.subdevice.empty() ? node_ : settings_.subdevice;
        const FileDescriptor fd = open_for_controls(holder);
        set_v4l2_controls(fd.get(), holder.string(), settings_.controls, settings_.control_places);
    }
    device_ = std::make_unique<V4l2Device>(
        node_, settings_.buffers,
        [this](std::uint32_t now, std::span<const std::uint32_t> offered) {
            return choose_format(now, offered);
        });
    const EvtEncoding encoding = encoding_given();
    SensorInfo info;
    info.name = device_->card();
    info.format = coding_of(encoding).format;
    const auto sensor =
        settings_.subdevice.empty() ? std::nullopt : subdevice_size(settings_.subdevice);
    info.width = settings_.width ? settings_.width : sensor ? sensor->first : device_->width();
    info.height = settings_.height ? settings_.height : sensor ? sensor->second : device_->height();
    if (info.width < 1 || info.width > kLargestSensorSide || info.height < 1 ||
        info.height > kLargestSensorSide)
        throw Error(ErrorKind::device,
                    "the camera " + node_.string() + " says its sensor is " +
                        std::to_string(info.width) + "x" + std::to_string(info.height) +
                        " px: state size = [width, height] in the camera's settings");
    if (info_.width == 0) {
        info_ = std::move(info);
        fourcc_ = device_->fourcc();
        encoding_ = encoding;
    } else {
        require_same(info);
    }
    last_sequence_.reset();
}

/// What another program left may be a format without events; one of which the user says what it
/// carries stays. A camera that is back is set to what it had.
std::optional<std::uint32_t> V4l2Camera::choose_format(
    std::uint32_t now, std::span<const std::uint32_t> offered) const {
    const auto is_right = [this](std::uint32_t fourcc) {
        const auto encoding = encoding_of(fourcc);
        if (fourcc_ != 0) return fourcc == fourcc_;
        return encoding && (!settings_.encoding || encoding == settings_.encoding);
    };
    if (is_right(now) || (settings_.encoding && !encoding_of(now))) return std::nullopt;
    const auto found = std::ranges::find_if(offered, is_right);
    return found == offered.end() ? std::nullopt : std::optional{*found};
}

EvtEncoding V4l2Camera::encoding_given() const {
    const auto said = encoding_of(device_->fourcc());
    const std::string gives = "the camera " + node_.string() + " gives format '" +
                              fourcc_text(device_->fourcc()) + "', expected ";
    if (said && settings_.encoding && said != settings_.encoding)
        throw Error(ErrorKind::device, gives + fourcc_text(coding_of(*settings_.encoding).fourcc) +
                                           ", as encoding in the camera's settings says");
    if (!said && !settings_.encoding)
        throw Error(ErrorKind::device,
                    gives +
                        "PSEE, PSE1, PSE2 or PSE3; where it carries events all the same, "
                        "say encoding = \"evt3\" (and the size) in the camera's settings");
    return said ? *said : *settings_.encoding;
}

/// Whatever else is at the node by now is not taken for the camera.
void V4l2Camera::require_same(const SensorInfo& found) const {
    if (device_->fourcc() == fourcc_ && found.name == info_.name && found.width == info_.width &&
        found.height == info_.height)
        return;
    throw Error(ErrorKind::device, "the camera " + node_.string() + " came back as " +
                                       device_text(found, device_->fourcc()) + ", expected " +
                                       device_text(info_, fourcc_) +
                                       " as before: set it up as it was (media-ctl)");
}

ReadStatus V4l2Camera::read(RawPacket& into) {
    into.bytes.clear();
    if (stopped_) return ReadStatus::end;
    if (!device_) return wait_for_return();
    V4l2Device::Filled filled;
    switch (device_->read(filled, kReadTimeout)) {
        case V4l2Device::Status::lost:
            return lost(filled.why);
        case V4l2Device::Status::timeout:
            return ReadStatus::timeout;
        case V4l2Device::Status::data:
            break;
    }
    if (reopened_) {
        count(CameraCount::reconnects);
        warnings_.is_back();
    }
    note_sequence(filled.sequence);
    const auto bytes = before_end_of_data(filled.bytes, encoding_);
    into.bytes.assign(bytes.begin(), bytes.end());
    into.arrived = std::chrono::steady_clock::now();
    into.gap_before = std::exchange(gap_, filled.damaged);  // a damaged buffer may lack its end
    into.reopened = std::exchange(reopened_, false);
    count(CameraCount::transfers);
    count(CameraCount::bytes, bytes.size());
    if (filled.damaged) count(CameraCount::damaged_transfers);
    return ReadStatus::data;
}

/// A jump forward is as many buffers lost by the driver. Some drivers do not count at all: a number
/// that stands still says nothing; one that falls says that the driver began anew.
void V4l2Camera::note_sequence(std::uint32_t sequence) {
    constexpr std::uint32_t kBackwards = std::uint32_t{1} << 31;
    const std::uint32_t step = sequence - last_sequence_.value_or(sequence);
    if (step > 1) gap_ = true;
    if (step > 1 && step < kBackwards) count(CameraCount::lost_transfers, step - 1);
    last_sequence_ = sequence;
}

ReadStatus V4l2Camera::lost(const std::string& why) {
    const std::string name = "the camera " + node_.string();
    if (!reconnect_) throw Error(ErrorKind::device, name + " stopped (" + why + ")" + kReconnect);
    device_.reset();
    if (!reopened_) return wait_for_return();
    warnings_.tell(
        Error(ErrorKind::device, name + " is there, but stops before it gives data (" + why + ")"));
    std::this_thread::sleep_for(kReadTimeout);
    return ReadStatus::timeout;
}

ReadStatus V4l2Camera::wait_for_return() {
    try {
        open();
        gap_ = reopened_ = true;
    } catch (const Error& error) {  // not there yet: the next look will tell
        device_.reset();
        warnings_.tell(error);
        std::this_thread::sleep_for(kReadTimeout);
    }
    return ReadStatus::timeout;
}

std::unique_ptr<Parser> V4l2Camera::make_parser() const {
    const int width = info_.width, height = info_.height;
    switch (encoding_) {
        case EvtEncoding::evt2:
            return std::make_unique<Evt2Parser>(width, height);
        case EvtEncoding::evt21:
            return std::make_unique<Evt21Parser>(width, height);
        case EvtEncoding::evt21_swapped:
            return std::make_unique<Evt21Parser>(width, height,
                                                 Evt21Parser::Order::upper_half_first);
        case EvtEncoding::evt3:
            break;
    }
    return std::make_unique<Evt3Parser>(width, height);
}

}  // namespace eventide
