// A DAVIS346 that sends as many events a second as it is told, for as long as it runs.
#pragma once

#include "src/core/event.h"
#include "tests/support/usb/davis_model.h"
#include "tests/support/usb/usb_model.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace eventide::testing_support {

struct FireHoseSettings {
    int events_per_us = 12;
    /// What the camera's memory and the transfers in flight hold together: what is not fetched
    /// before they are full is dropped, and counted as the camera counts (MUX 83).
    std::size_t buffer_bytes = 1 << 20;
    std::function<SensorTime()> now;  ///< real time, or a test's
};

/// Every event has a row word and a column word of its own, every microsecond a time word: with 12
/// events in each, 50 MB/s. The words of one wrap of the time (32,768 us) are made beforehand, so
/// that sending is copying.
class DavisFireHose final : public UsbModel {
public:
    explicit DavisFireHose(FireHoseSettings settings);

    UsbModelIdentity identity() const override { return registers_.identity(); }
    int control(const UsbSetup& setup, std::span<std::uint8_t> data) override;
    /// A transfer that fills; 0 while too little has happened.
    std::size_t send(std::span<std::byte> out) override;
    void clear_endpoint() override {}

    /// Event number k since the start.
    Event event(std::uint64_t k) const;
    std::uint64_t dropped() const { return dropped_; }

private:
    std::uint64_t bytes_until(SensorDuration time) const;
    std::uint64_t us_at(std::uint64_t bytes) const;
    void drop_what_finds_no_room(std::uint64_t happened);
    std::size_t bytes_per_us() const { return 2 * (1 + 2 * std::size_t(settings_.events_per_us)); }

    FireHoseSettings settings_;
    DavisModel registers_;  ///< answers everything but the data endpoint
    std::vector<std::byte> wrap_;
    bool running_ = false, marker_sent_ = false;  ///< from DVS run on, and again from each reset
    SensorTime begun_{};
    std::uint64_t sent_ = 0;  ///< bytes since the start, with the dropped ones
    std::uint64_t dropped_ = 0;
};

}  // namespace eventide::testing_support
