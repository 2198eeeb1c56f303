#include "tests/support/usb/dvxplorer_model.h"

#include "drivers/usb/dvxplorer_registers.h"
#include "src/codec/inivation/davis_sensor.h"
#include "tests/support/usb/dvxplorer_words.h"
#include "tests/support/usb/register_requests.h"

#include <algorithm>

namespace eventide::testing_support {

using namespace davis;

DvxplorerModel::DvxplorerModel(DvxplorerModelSettings settings) : settings_(std::move(settings)) {
    const DvxplorerSensor& s = settings_.sensor;
    const auto bits = [](bool two, bool one, bool zero) {
        return std::uint32_t(two ? 4 : 0) | std::uint32_t(one ? 2 : 0) |
               std::uint32_t(zero ? 1 : 0);
    };
    registers_ = {{kLogicVersion, settings_.logic},
                  {kLogicPatch, settings_.patch},
                  {kChipId, settings_.chip},
                  {kIsMaster, 1},
                  {kLogicMhz, 104},
                  {kUsbMhz, 30},
                  {kClockDeviation, 1000},
                  {kDvsColumns, std::uint32_t(s.columns())},
                  {kDvsRows, std::uint32_t(s.rows())},
                  {kDvsOrientation, bits(s.swapped, settings_.flip_x, settings_.flip_y)},
                  {kImuType, kImuBmi160},
                  {kImuOrientation, bits(s.imu_flip_x, s.imu_flip_y, s.imu_flip_z)},
                  {kExtHasGenerator, 1},
                  {kMuxHasStatistics, 1}};
    if (settings_.mini) {  // its firmware sets up the chip
        registers_[dvxplorer::kPacketFormat] = 0x80;
        registers_[dvxplorer::kModeControl] = 0x0C;
    }
}

std::uint32_t DvxplorerModel::read(Register at) const {
    const auto found = registers_.find(at);
    return found == registers_.end() ? 0 : found->second;
}

void DvxplorerModel::write(Write write) {
    writes_.push_back(write);
    if (write.at == settings_.deaf || (is_lite() && write.at == dvxplorer::kDualBinning)) return;
    registers_[write.at] = write.value;
    asked_ = 0;
    const Register reset = settings_.mini ? dvxplorer::kTimestampReset : kTimestampReset;
    const bool resets = write == Write{reset, 1};
    if (!resets && (is_streaming() || !begun_)) return;
    clear_endpoint();  // a new beginning, or the end
    was_reset_ = resets;
    begun_ = false;
}

UsbModelIdentity DvxplorerModel::identity() const {
    UsbModelIdentity identity;
    identity.product = 0x8419;
    identity.firmware = settings_.firmware;
    identity.board_type = settings_.mini ? 4 : settings_.board_type;
    identity.serial = settings_.serial;
    return identity;
}

int DvxplorerModel::control(const UsbSetup& setup, std::span<std::uint8_t> data) {
    constexpr int kSecondGeneration = 10;  // asks for eight bytes
    if (settings_.firmware >= kSecondGeneration) return -1;
    return answer_register_request(*this, setup, data);
}

bool DvxplorerModel::is_streaming() const {
    const bool chip_streams = read(dvxplorer::kMode) == dvxplorer::kModeStream;
    if (settings_.mini) return chip_streams && is_set(kDvsRun);
    return is_set(kRun) && is_set(kTimestampRun) && is_set(kUsbRun);
}

int DvxplorerModel::two_bytes(Register at) const {
    return int((read(at) << 8) | read({at.module, std::uint16_t(at.address + 1)}));
}

/// Ratios are one less than the step, of a Lite one less than twice that.
bool DvxplorerModel::is_left_out(int row_or_column, std::uint32_t ratio) const {
    const int step = (int(ratio) + 1) / (is_lite() ? 2 : 1);
    return step > 1 && row_or_column % step != 0;
}

/// The cropper, subsampling and the polarity bits of the packet format.
bool DvxplorerModel::sees(const Event& event) const {
    using namespace dvxplorer;
    const auto format = read(kPacketFormat);
    if (event.polarity == Polarity::off && (format & 0x20) != 0) return false;
    if (event.polarity == Polarity::on && (format & 0x10) != 0) return false;
    const auto [column, row] = device_axes(event, settings_.sensor);
    constexpr std::uint32_t kNoSubsampling = 0x04;
    const auto ratio = read(kSubsampleRatio);
    if ((read(kDigitalEnable) & kNoSubsampling) == 0 &&
        (is_left_out(column, ratio & 7) || is_left_out(row, ratio >> 3)))
        return false;
    if (read(kCropBypass) == 1) return true;
    if (column < two_bytes(kCropXStart) || column > two_bytes(kCropXEnd)) return false;
    const auto group = std::uint32_t(row / 8), bit = 1U << (row % 8);
    const auto first = read(kCropYStartGroup), last = read(kCropYEndGroup);
    if (group < first || group > last) return false;
    if (group == last) return (read(kCropYEndMask) & bit) != 0;  // also where it is the first
    return group != first || (read(kCropYStartMask) & bit) != 0;
}

std::vector<Event> DvxplorerModel::seen_events() const {
    std::vector<Event> seen;
    const bool on = is_set(kDvsRun) && (settings_.mini || is_set(kRunChip)) &&
                    read(dvxplorer::kMode) == dvxplorer::kModeStream;
    if (on)
        std::copy_if(scene_.events.begin(), scene_.events.end(), std::back_inserter(seen),
                     [&](const Event& event) { return sees(event); });
    return seen;
}

void DvxplorerModel::begin_scene() {
    begun_ = true;
    Batch seen;
    seen.events = seen_events();
    if (is_set(kImuRunAccel)) seen.imu = scene_.imu;
    const ImuRanges ranges{int(read(dvxplorer::kImuAccelRange)),
                           int(read(dvxplorer::kImuGyroRange))};
    if (settings_.mini) {
        MiniStream stream = mini_stream(seen, settings_.sensor, ranges);
        words_ = std::move(stream.words);
        messages_ = std::move(stream.messages);
        return;
    }
    if (is_set(kExtRun)) seen.triggers = scene_.triggers;
    words_ = fx3_words(seen, settings_.sensor, ranges, was_reset_);
}

std::size_t DvxplorerModel::send(std::span<std::byte> out) {
    if (!is_streaming()) return 0;
    const bool sees = is_set(kDvsRun) || is_set(kImuRunAccel) || is_set(kExtRun);
    if (!begun_ && !was_reset_ && (!sees || ++asked_ <= kSettled)) return 0;
    if (!begun_) begin_scene();
    // A message falls where it belongs: the packet before it is short, and the next waits for it.
    const std::size_t end = told_ < messages_.size() ? messages_[told_].after : words_.size();
    const std::size_t n = std::min(out.size(), end - sent_);
    std::copy_n(words_.begin() + std::ptrdiff_t(sent_), n, out.begin());
    sent_ += n;
    return n;
}

std::size_t DvxplorerModel::message(std::span<std::byte> out) {
    if (told_ == messages_.size() || messages_[told_].after > sent_) return 0;
    const std::vector<std::byte>& bytes = messages_[told_++].bytes;
    std::ranges::copy(bytes, out.begin());
    return bytes.size();
}

void DvxplorerModel::clear_endpoint() {
    words_.clear();
    messages_.clear();
    sent_ = told_ = 0;
}

}  // namespace eventide::testing_support
