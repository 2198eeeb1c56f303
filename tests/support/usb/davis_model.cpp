#include "tests/support/usb/davis_model.h"

#include "tests/support/usb/register_requests.h"

#include <algorithm>
#include <utility>

namespace eventide::testing_support {

using namespace davis;

namespace {

std::uint32_t orientation(bool bit2, bool bit1, bool bit0) {
    return std::uint32_t(bit2 ? 4 : 0) | std::uint32_t(bit1 ? 2 : 0) | std::uint32_t(bit0 ? 1 : 0);
}

void move_in_time(Batch& data, SensorDuration shift) {
    for (Event& event : data.events) event.t += shift;
    for (ImuSample& sample : data.imu) sample.t += shift;
    for (Trigger& edge : data.triggers) edge.t += shift;
    for (ReferenceImage& image : data.images) {
        image.t += shift;
        image.exposure_begin += shift;
        image.exposure_end += shift;
    }
}

/// Moves the items of `from` with key(item) <= t, from `next` on, to `to`.
template <typename Item, typename Key>
void take_until(const std::vector<Item>& from, std::size_t& next, SensorTime t, Key key,
                bool wanted, std::vector<Item>& to) {
    for (; next < from.size() && key(from[next]) <= t; ++next)
        if (wanted) to.push_back(from[next]);
}

}  // namespace

// What the registers of a real camera hold after power-up (docs/protocols.md A.4 and A.14).
DavisModel::DavisModel(DavisModelSettings settings) : settings_(std::move(settings)) {
    const DavisSensor& s = settings_.sensor;
    registers_ = {{kLogicVersion, settings_.logic},
                  {kLogicPatch, settings_.patch},
                  {kChipId, std::uint32_t(s.chip)},
                  {kIsMaster, 1},
                  {kLogicMhz, 90},
                  {kAdcMhz, 30},
                  {kUsbMhz, 30},
                  {kClockDeviation, 1000},
                  {kDvsColumns, std::uint32_t(s.dvs_columns)},
                  {kDvsRows, std::uint32_t(s.dvs_rows)},
                  {kDvsOrientation, orientation(s.dvs_swapped, false, false)},
                  {kDvsHasPixelFilter, 1},
                  {kDvsHasActivityFilter, 1},
                  {kDvsHasRoi, 1},
                  {kDvsHasSkip, 1},
                  {kDvsHasPolarityFilter, 1},
                  {kDvsHasStatistics, settings_.dvs_statistics ? 1U : 0U},
                  {kApsColumns, std::uint32_t(s.aps_columns)},
                  {kApsRows, std::uint32_t(s.aps_rows)},
                  {kApsOrientation, orientation(s.aps_swapped, s.aps_flip_x, s.aps_flip_y)},
                  {kApsColorFilter, std::uint32_t(s.colour_filter)},
                  {kApsHasGlobalShutter, 1},
                  {kImuType, std::uint32_t(s.imu_type)},
                  {kImuOrientation, orientation(s.imu_flip_x, s.imu_flip_y, s.imu_flip_z)},
                  {kExtHasGenerator, 1},
                  {kMuxHasStatistics, settings_.mux_statistics ? 1U : 0U}};
}

void DavisModel::show(Batch scene) {
    scene_ = std::move(scene);
}

std::uint32_t DavisModel::read(Register at) const {
    const auto found = registers_.find(at);
    return found == registers_.end() ? 0 : found->second;
}

/// Of the IMU's registers, and those of the newer chips, as libcaer writes them.
bool DavisModel::has(Register at) const {
    constexpr Register kGreyCounter{chip, kChipConfig + 15}, kTestAdc{chip, kChipConfig + 16};
    const DavisSensor& s = settings_.sensor;
    if (at.module == imu && s.imu_type == kNoImu) return false;
    if (at == kImuGyroLowPass) return s.imu_type == kImuMpu6500;
    return !s.is_davis240() || (at != kGreyCounter && at != kTestAdc);
}

void DavisModel::write(Write write) {
    const bool time_starts = write == Write{kTimestampRun, 1} && read(kTimestampRun) != 1;
    writes_.push_back(write);
    if (has(write.at)) registers_[write.at] = write.value;
    asked_ = 0;
    if (time_starts) begin_time();
    if (write != Write{kTimestampReset, 1}) return;
    begin_time();
    DavisWriter::timestamp_reset(words_);
    begin_scene(SensorDuration{0});
}

void DavisModel::begin_time() {
    clear_endpoint();
    time_began_ = settings_.now ? settings_.now() : SensorTime{};
    writer_ = std::make_unique<DavisWriter>(settings_.sensor);
    event_ = image_ = imu_ = trigger_ = 0;
    scene_began_ = SensorDuration{0};
    scene_runs_ = false;
}

void DavisModel::begin_scene(SensorDuration after) {
    scene_began_ = after;
    scene_runs_ = true;
}

bool DavisModel::sees_something() const {
    return (read(kDvsRun) == 1 && read(kRunChip) == 1) || read(kApsRun) == 1 ||
           read(kImuRunAccel) == 1 || read(kExtRun) == 1;
}

UsbModelIdentity DavisModel::identity() const {
    UsbModelIdentity identity;
    identity.product = settings_.product;
    identity.firmware = settings_.firmware;
    identity.board_type = settings_.board_type;
    identity.serial = settings_.serial;
    identity.superspeed = settings_.product == 0x841A;
    return identity;
}

int DavisModel::control(const UsbSetup& setup, std::span<std::uint8_t> data) {
    return answer_register_request(*this, setup, data);
}

void DavisModel::clear_endpoint() {
    words_.clear();
    sent_ = 0;
}

bool DavisModel::is_streaming() const {
    return read(kRun) == 1 && read(kTimestampRun) == 1 && read(kUsbRun) == 1;
}

bool DavisModel::is_scene_over() const {
    return event_ == scene_.events.size() && image_ == scene_.images.size() &&
           imu_ == scene_.imu.size() && trigger_ == scene_.triggers.size() &&
           sent_ == words_.size();
}

std::size_t DavisModel::send(std::span<std::byte> out) {
    if (!is_streaming() || !writer_) return 0;
    if (!scene_runs_ && sees_something() && ++asked_ > kSettled)
        begin_scene(settings_.now ? now().time_since_epoch() : SensorDuration{0});
    while (words_.size() - sent_ < out.size()) {
        const std::size_t before = words_.size();
        make_more(out.size());
        if (words_.size() == before) break;
    }
    const std::size_t n = std::min(out.size(), words_.size() - sent_);
    if (n < out.size() && is_too_early_for_part_of_a_packet(n)) return 0;
    std::copy_n(words_.begin() + std::ptrdiff_t(sent_), n, out.begin());
    sent_ += n;
    bytes_sent_ += n;
    if (sent_ == words_.size()) clear_endpoint();
    return n;
}

/// In real time a buffer that is not full waits for more, but not for long (USB register 1), and
/// only then does a transfer end early. Each full one begins the wait anew.
bool DavisModel::is_too_early_for_part_of_a_packet(std::size_t queued) {
    constexpr std::size_t kHighSpeedBuffer = 512, kSuperSpeedBuffer = 8192;
    if (!settings_.now) return false;
    const SensorDuration delay{read(kUsbEarlyPacketDelay) / read(kUsbMhz)};
    const SensorTime t = settings_.now();
    const std::size_t full =
        queued / (identity().superspeed ? kSuperSpeedBuffer : kHighSpeedBuffer);
    if (std::exchange(full_buffers_, full) != full) waits_since_ = t;
    if (t - waits_since_ < delay) return true;
    waits_since_ = t;
    return false;
}

SensorTime DavisModel::now() const {
    return SensorTime{settings_.now() - time_began_};
}

void DavisModel::make_more(std::size_t bytes) {
    constexpr std::size_t kBytesPerEvent = 4, kFewestEvents = 256;
    constexpr SensorDuration kWrap{1 << 15};
    std::vector<std::byte> stretch;
    const SensorTime clock = settings_.now ? now() - scene_began_ : SensorTime::max();
    SensorTime until = clock;
    if (scene_runs_) {
        until = end_of_stretch(std::max(kFewestEvents, bytes / kBytesPerEvent), clock);
        Batch seen = next_stretch(until);
        if (settings_.fifo_bytes > 0) drop_what_finds_no_room(seen.events);
        move_in_time(seen, scene_began_);
        writer_->write(seen, stretch);
    }
    // A silent camera still says how time goes by, once a wrap.
    if (settings_.now && until == clock && clock + scene_began_ - writer_->time() >= kWrap)
        writer_->advance(clock + scene_began_, stretch);
    if (settings_.spoil) settings_.spoil(stretch);
    words_.erase(words_.begin(), words_.begin() + std::ptrdiff_t(sent_));
    sent_ = 0;
    words_.insert(words_.end(), stretch.begin(), stretch.end());
}

/// Images are sent in the stretch their exposure begins in, so it reaches to the end of every
/// exposure in it.
SensorTime DavisModel::end_of_stretch(std::size_t events, SensorTime clock) const {
    SensorTime until = event_ + events < scene_.events.size() ? scene_.events[event_ + events].t
                                                              : SensorTime::max();
    // With little memory the camera cannot put off what it sees until it is fetched.
    if (settings_.fifo_bytes > 0 && settings_.now) until = SensorTime::max();
    until = std::min(until, clock);
    for (std::size_t i = image_;
         i < scene_.images.size() && scene_.images[i].exposure_begin <= until; ++i)
        until = std::max(until, scene_.images[i].exposure_end);
    return until;
}

void DavisModel::drop_what_finds_no_room(std::vector<Event>& events) {
    constexpr std::size_t kBytesPerEvent = 4;
    constexpr Register kDroppedLow{kMuxDroppedDvs.module, kMuxDroppedDvs.address + 1};
    const std::size_t queued = std::min(words_.size() - sent_, settings_.fifo_bytes);
    const std::size_t room = (settings_.fifo_bytes - queued) / kBytesPerEvent;
    if (events.size() <= room) return;
    const std::uint64_t dropped =
        ((std::uint64_t(read(kMuxDroppedDvs)) << 32) | read(kDroppedLow)) + (events.size() - room);
    registers_[kMuxDroppedDvs] = std::uint32_t(dropped >> 32);
    registers_[kDroppedLow] = std::uint32_t(dropped);
    events.resize(room);
}

/// The scene up to `until`, as far as what is switched on sees it.
Batch DavisModel::next_stretch(SensorTime until) {
    const bool dvs_on = read(kDvsRun) == 1 && read(kRunChip) == 1, aps_on = read(kApsRun) == 1,
               imu_on = read(kImuRunAccel) == 1, ext_on = read(kExtRun) == 1;
    Batch part;
    take_until(
        scene_.events, event_, until, [](const Event& e) { return e.t; }, dvs_on, part.events);
    take_until(
        scene_.images, image_, until, [](const ReferenceImage& i) { return i.exposure_begin; },
        aps_on, part.images);
    take_until(
        scene_.imu, imu_, until, [](const ImuSample& s) { return s.t; }, imu_on, part.imu);
    take_until(
        scene_.triggers, trigger_, until, [](const Trigger& e) { return e.t; }, ext_on,
        part.triggers);
    return part;
}

}  // namespace eventide::testing_support
