// DVXplorer USB words -> events, IMU samples, triggers (docs/protocols.md A.12): the FX3 "red"
// board. The CX3 board of the Mini has words of its own (dvxplorer_mini.h).
#pragma once

#include "src/codec/inivation/davis_imu.h"
#include "src/codec/inivation/dvxplorer_sensor.h"
#include "src/codec/inivation/inivation_clock.h"
#include "src/codec/parser.h"
#include "src/codec/whole_words.h"

#include <array>
#include <cstdint>
#include <optional>

namespace eventide {

/// 16-bit words of the FX3 board. A column's events come as masks of eight rows, for two groups of
/// rows at a time.
class DvxplorerParser final : public Parser {
public:
    explicit DvxplorerParser(const DvxplorerSensor& sensor);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    void arrives(HostTime at) override { clock_.arrives(at, damage_); }
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    void word(std::uint16_t word, Batch& into);
    void special(std::uint16_t data, Batch& into);
    void group_addresses(std::uint16_t data);
    void group(int first_row, std::uint16_t data, Batch& into);
    void imu_end(Batch& into);

    DvxplorerSensor sensor_;
    DavisImuAssembler imu_;
    IniVationClock<15> clock_;
    Damage damage_;
    WholeWords<2> words_;
    int column_ = -1;                  ///< -1: not known since the start or a loss
    std::array<int, 2> rows_{-1, -1};  ///< first row of the two groups
};

}  // namespace eventide
