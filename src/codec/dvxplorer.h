// DVXplorer USB words -> events, IMU samples, triggers (drivers-and-formats.md A.12): the FX3 "red"
// board and the CX3 Mini.
#pragma once

#include "src/codec/davis_imu.h"
#include "src/codec/inivation_clock.h"
#include "src/codec/parser.h"
#include "src/codec/whole_words.h"

#include <array>
#include <cstdint>
#include <optional>

namespace eventide {

struct DvxplorerSensor {
    int width = 640, height = 480;  ///< px, as a person sees it; Lite: 320x240
    bool swapped = false;  ///< orientation bit 2: the chip's columns are the picture's rows
    bool imu_flip_x = false, imu_flip_y = false,
         imu_flip_z = false;  ///< IMU orientation bits 2, 1, 0

    int columns() const { return swapped ? height : width; }
    int rows() const { return swapped ? width : height; }
};

/// 16-bit words of the FX3 board. A column's events come as masks of eight rows, for two groups of
/// rows at a time.
class DvxplorerParser final : public Parser {
public:
    explicit DvxplorerParser(const DvxplorerSensor& sensor);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    void expect_passed(SensorDuration passed) override { clock_.expect_passed(passed); }
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

/// 32-bit words of the CX3 board (Mini, Micro). The sensor is read out frame by frame: the first
/// column of a frame says its time, as microseconds after the last reference, which comes every
/// millisecond; within a frame the columns rise, so a column that does not tells of a loss, and
/// what follows is left out until the next frame.
class DvxplorerMiniParser final : public Parser {
public:
    explicit DvxplorerMiniParser(const DvxplorerSensor& sensor) : sensor_(sensor) {}

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    /// Where the next reference is far from the guess the camera began anew, and time goes on from
    /// the guess.
    void expect_passed(SensorDuration passed) override { expected_ = time_ + passed.count(); }
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    void word(std::uint32_t word, Batch& into);
    void reference(std::int64_t us);
    void settle(std::int64_t us);
    void column(std::uint32_t word);
    void group(int first_row, std::uint32_t mask, bool off, Batch& into);

    DvxplorerSensor sensor_;
    Damage damage_;
    WholeWords<4> words_;
    std::int64_t base_ = 0;        ///< us, of reference 0
    std::int64_t reference_ = -1;  ///< us since base_; -1: not known since the start or a loss
    std::int64_t time_ = 0;        ///< us
    std::optional<std::int64_t> expected_;
    bool begun_ = false;
    int column_ = -1;  ///< -1: no frame has begun since the start or a loss
};

}  // namespace eventide
