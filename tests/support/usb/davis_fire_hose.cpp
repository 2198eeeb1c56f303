#include "tests/support/usb/davis_fire_hose.h"

#include <algorithm>
#include <stdexcept>

namespace eventide::testing_support {

using namespace davis;

namespace {

constexpr std::int64_t kWrapUs = 1 << 15;
constexpr std::uint16_t kTime = 0x8000, kRow = 0x1000, kOffColumn = 0x2000, kOneWrap = 0x7001;
constexpr std::uint64_t kColumns = 260, kRows = 346;
constexpr std::size_t kWord = 2;
constexpr Register kDroppedLow{kMuxDroppedDvs.module, kMuxDroppedDvs.address + 1};

void put(std::uint64_t word, std::vector<std::byte>& out) {
    out.push_back(std::byte(word & 0xFF));
    out.push_back(std::byte(word >> 8));
}

}  // namespace

DavisFireHose::DavisFireHose(FireHoseSettings settings)
    : settings_(std::move(settings)), registers_(DavisModelSettings{}) {
    std::uint64_t k = 0;
    for (std::int64_t t = 0; t < kWrapUs; ++t) {
        put(kTime | std::uint64_t(t), wrap_);
        for (int i = 0; i < settings_.events_per_us; ++i, ++k) {
            const Event e = event(k);
            put(kRow | e.x, wrap_);  // DAVIS346: the chip's rows are the frame's columns
            put((kOffColumn + (e.polarity == Polarity::on ? 0x1000 : 0)) | e.y, wrap_);
        }
    }
    put(kOneWrap, wrap_);
}

Event DavisFireHose::event(std::uint64_t k) const {
    const auto n = std::uint64_t(settings_.events_per_us);
    const std::uint64_t in_wrap = k % (n * kWrapUs);
    return {from_us(std::int64_t(k / n)), std::uint16_t(in_wrap * 7 % kRows),
            std::uint16_t(in_wrap * 13 % kColumns), Polarity(in_wrap % 2)};
}

int DavisFireHose::control(const UsbSetup& setup, std::span<std::uint8_t> data) {
    const auto resets = [&] {
        const auto& writes = registers_.writes();
        return std::count(writes.begin(), writes.end(), Write{kTimestampReset, 1});
    };
    const auto before = resets();
    const int n = registers_.control(setup, data);
    const bool reset = resets() > before;
    const bool was_running = running_ && !reset;
    running_ = registers_.is_streaming() && registers_.read(kDvsRun) == 1;
    if (running_ && !was_running) {
        begun_ = settings_.now();
        sent_ = 0;
        marker_sent_ = !reset;  // there is none without a reset
    }
    return n;
}

std::uint64_t DavisFireHose::bytes_until(SensorDuration time) const {
    const auto us = std::uint64_t(std::max<std::int64_t>(time.count(), 0));
    return us / kWrapUs * wrap_.size() + us % kWrapUs * bytes_per_us();
}

std::uint64_t DavisFireHose::us_at(std::uint64_t bytes) const {
    const std::uint64_t in_wrap = bytes % wrap_.size() / bytes_per_us();
    return bytes / wrap_.size() * kWrapUs + std::min<std::uint64_t>(in_wrap, kWrapUs - 1);
}

std::size_t DavisFireHose::send(std::span<std::byte> out) {
    if (!running_ || out.size() < kWord) return 0;
    if (!marker_sent_) {
        marker_sent_ = true;
        std::fill_n(out.begin(), kWord, std::byte{0});
        out[0] = std::byte{1};  // timestamp reset
        return kWord;
    }
    const std::uint64_t happened = bytes_until(settings_.now() - begun_);
    drop_what_finds_no_room(happened);
    if (happened < sent_ + out.size()) return 0;
    for (std::size_t filled = 0; filled < out.size();) {
        const std::size_t at = sent_ % wrap_.size();
        const std::size_t n = std::min(out.size() - filled, wrap_.size() - at);
        std::copy_n(wrap_.begin() + std::ptrdiff_t(at), n, out.begin() + std::ptrdiff_t(filled));
        filled += n;
        sent_ += n;
    }
    return out.size();
}

/// Goes on with a later microsecond.
void DavisFireHose::drop_what_finds_no_room(std::uint64_t happened) {
    if (happened <= sent_ + settings_.buffer_bytes) return;
    const std::uint64_t from = us_at(sent_), to = us_at(happened - settings_.buffer_bytes) + 1;
    sent_ = bytes_until(SensorDuration{std::int64_t(to)});
    dropped_ += (to - from) * std::uint64_t(settings_.events_per_us);
    registers_.write({kMuxDroppedDvs, std::uint32_t(dropped_ >> 32)});
    registers_.write({kDroppedLow, std::uint32_t(dropped_)});
}

}  // namespace eventide::testing_support
