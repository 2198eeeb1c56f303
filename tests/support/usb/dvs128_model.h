// A DVS128 in software: its requests and its records.
#pragma once

#include "src/core/event.h"
#include "tests/support/usb/usb_model.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace eventide::testing_support {

/// Records flow, and the scene begins, from START to STOP. A reset of the time drops what was
/// queued, sends its mark, and the scene begins anew; a slave does not listen to it.
class Dvs128Model final : public UsbModel {
public:
    struct Request {
        std::uint8_t request;
        std::uint16_t value;
        std::vector<std::uint8_t> data;
        friend bool operator==(const Request&, const Request&) = default;
    };

    explicit Dvs128Model(std::uint8_t firmware = 14) : firmware_(firmware) {}

    void show(Batch scene) { scene_ = std::move(scene); }
    const std::vector<Request>& requests() const { return requests_; }  ///< all, in order
    bool is_scene_over() const { return begun_ && sent_ == bytes_.size(); }

    UsbModelIdentity identity() const override;
    int control(const UsbSetup& setup, std::span<std::uint8_t> data) override;
    std::size_t send(std::span<std::byte> out) override;
    void clear_endpoint() override;

private:
    void begin_scene(bool by_reset);

    std::uint8_t firmware_;
    std::vector<Request> requests_;
    Batch scene_;
    bool running_ = false, begun_ = false, master_ = true;
    std::vector<std::byte> bytes_;
    std::size_t sent_ = 0;  ///< of bytes_
};

}  // namespace eventide::testing_support
