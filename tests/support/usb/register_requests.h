// iniVation's requests for registers (docs/protocols.md A.3), seen from the camera's side.
#pragma once

#include "drivers/usb/davis_registers.h"
#include "tests/support/usb/usb_model.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace eventide::testing_support {

/// 0xBF: one register; 0xC2: several, six bytes each. Values are big-endian. Calls camera.read(at)
/// and camera.write(write); the result is UsbModel::control()'s.
template <typename Camera>
int answer_register_request(Camera& camera, const UsbSetup& setup, std::span<std::uint8_t> data) {
    constexpr std::uint8_t kOut = 0x40, kIn = 0xC0, kOne = 0xBF, kMany = 0xC2;
    constexpr std::size_t kValueBytes = 4, kWriteBytes = 6;
    const auto big32 = [&](std::size_t at) {
        return (std::uint32_t(data[at]) << 24) | (std::uint32_t(data[at + 1]) << 16) |
               (std::uint32_t(data[at + 2]) << 8) | data[at + 3];
    };
    if (setup.request == kOne && setup.type == kIn && data.size() >= kValueBytes) {
        const std::uint32_t number = camera.read(davis::Register{setup.value, setup.index});
        for (std::size_t i = 0; i < kValueBytes; ++i)
            data[i] = std::uint8_t(number >> (24 - 8 * i));
        return int(kValueBytes);
    }
    if (setup.request == kOne && setup.type == kOut && data.size() == kValueBytes) {
        camera.write(davis::Write{{setup.value, setup.index}, big32(0)});
        return int(kValueBytes);
    }
    if (setup.request == kMany && setup.type == kOut && data.size() == kWriteBytes * setup.value) {
        for (std::size_t at = 0; at < data.size(); at += kWriteBytes)
            camera.write(davis::Write{{data[at], data[at + 1]}, big32(at + 2)});
        return int(data.size());
    }
    return -1;
}

}  // namespace eventide::testing_support
