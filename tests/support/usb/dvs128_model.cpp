#include "tests/support/usb/dvs128_model.h"

#include "src/core/byte_order.h"

#include <algorithm>

namespace eventide::testing_support {

UsbModelIdentity Dvs128Model::identity() const {
    UsbModelIdentity identity;
    identity.product = 0x8400;
    identity.firmware = firmware_;
    identity.serial = "DVS00128";
    identity.data_endpoint = 0x86;
    identity.superspeed = false;
    return identity;
}

int Dvs128Model::control(const UsbSetup& setup, std::span<std::uint8_t> data) {
    constexpr std::uint8_t kOut = 0x40, kStart = 0xB3, kStop = 0xB4, kSetBiases = 0xB8,
                           kResetTime = 0xBB, kSetMaster = 0xBE;
    constexpr std::size_t kBiasBytes = 36;
    if (setup.type != kOut) return -1;
    switch (setup.request) {
        case kStart:
        case kStop:
            running_ = setup.request == kStart;
            if (running_) begin_scene(false);
            break;
        case kResetTime:
            if (master_) begin_scene(true);
            break;
        case kSetBiases:
            if (data.size() != kBiasBytes) return -1;
            break;
        case kSetMaster:
            master_ = setup.value != 0;
            break;
        default:
            return -1;
    }
    requests_.push_back({setup.request, setup.value, {data.begin(), data.end()}});
    return int(data.size());
}

/// u16 address (bit 0 OFF, 1-7 x, 8-14 y, 15 sync; both mirrored) and u16 time (14 bits; bit 15 a
/// wrap, bit 14 a reset), little-endian.
void Dvs128Model::begin_scene(bool by_reset) {
    constexpr std::int64_t kWrapUs = 1 << 14;
    constexpr std::uint32_t kWrap = 0x80000000, kReset = 0x40000000, kSync = 0x8000;
    std::int64_t wrap_add = 0;
    const auto put = [&](std::uint32_t address, SensorTime at) {
        for (; to_us(at) - wrap_add >= kWrapUs; wrap_add += kWrapUs) append_little(bytes_, kWrap);
        append_little(bytes_, address | (std::uint32_t(to_us(at) - wrap_add) << 16));
    };
    clear_endpoint();
    begun_ = true;
    if (by_reset) append_little(bytes_, kReset);
    std::size_t trigger = 0;
    for (const Event& event : scene_.events) {
        for (; trigger < scene_.triggers.size() && scene_.triggers[trigger].t <= event.t; ++trigger)
            put(kSync, scene_.triggers[trigger].t);
        put((event.polarity == Polarity::off ? 1U : 0U) | (std::uint32_t(127 - event.x) << 1) |
                (std::uint32_t(127 - event.y) << 8),
            event.t);
    }
}

std::size_t Dvs128Model::send(std::span<std::byte> out) {
    if (!running_) return 0;
    const std::size_t n = std::min(out.size(), bytes_.size() - sent_);
    std::copy_n(bytes_.begin() + std::ptrdiff_t(sent_), n, out.begin());
    sent_ += n;
    return n;
}

void Dvs128Model::clear_endpoint() {
    bytes_.clear();
    sent_ = 0;
    begun_ = false;
}

}  // namespace eventide::testing_support
