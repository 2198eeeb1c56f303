// A DVXplorer in software, register by register, with either of its boards.
#pragma once

#include "drivers/usb/davis_registers.h"
#include "src/codec/inivation/dvxplorer_sensor.h"
#include "src/core/event.h"
#include "tests/support/usb/dvxplorer_words.h"
#include "tests/support/usb/usb_model.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace eventide::testing_support {

struct DvxplorerModelSettings {
    DvxplorerSensor sensor;
    bool flip_x = false, flip_y = false;  ///< orientation bits 1, 0
    bool mini = false;                    ///< a CX3 board
    std::string serial = "DVX00001";
    std::uint8_t firmware = 8, board_type = 3;  ///< a Mini has type 4
    std::uint32_t logic = 18, patch = 2, chip = 20;
    std::optional<davis::Register> deaf;  ///< does not take what is written to it
};

/// Registers, and the stream they let flow. The FX3 board sends words while MUX run, timestamp run
/// and USB run are 1; events with DVS run, chip run and the chip's stream mode, from inside its
/// cropper, of the rows and columns and of the polarity asked for; IMU samples with the
/// accelerometer on, in its range; edges with the detector on. The CX3 board has only the chip and
/// DVS run.
///
/// The scene begins at a timestamp reset, which drops what was queued; without one, when the board
/// streams, something that sees is on, and data were asked for kSettled times since the last
/// register was written: by then a driver has switched on all it wants.
///
/// Within one time the scene's events have to be in the order of the readout: by device column.
class DvxplorerModel final : public UsbModel {
public:
    static constexpr int kSettled = 500;  ///< requests; 50 ms through the testbed

    explicit DvxplorerModel(DvxplorerModelSettings settings);

    void show(Batch scene) { scene_ = std::move(scene); }
    std::uint32_t read(davis::Register at) const;
    void write(davis::Write write);
    const std::vector<davis::Write>& writes() const { return writes_; }  ///< all, in order
    bool is_scene_over() const { return begun_ && sent_ == words_.size(); }

    UsbModelIdentity identity() const override;
    int control(const UsbSetup& setup, std::span<std::uint8_t> data) override;
    std::size_t send(std::span<std::byte> out) override;
    std::size_t message(std::span<std::byte> out) override;
    void clear_endpoint() override;

private:
    bool is_streaming() const;
    bool is_set(davis::Register at) const { return read(at) == 1; }
    int two_bytes(davis::Register at) const;
    bool is_lite() const { return settings_.chip == 19; }
    bool is_left_out(int row_or_column, std::uint32_t ratio) const;
    bool sees(const Event& event) const;
    std::vector<Event> seen_events() const;
    void begin_scene();

    DvxplorerModelSettings settings_;
    std::map<davis::Register, std::uint32_t> registers_;
    std::vector<davis::Write> writes_;
    Batch scene_;
    bool was_reset_ = false;  ///< since the stream began
    int asked_ = 0;           ///< for data, since the last write
    bool begun_ = false;      ///< the scene
    std::vector<std::byte> words_;
    std::vector<MiniStream::Message> messages_;  ///< a Mini's, beside its words
    std::size_t sent_ = 0, told_ = 0;            ///< of words_, of messages_
};

}  // namespace eventide::testing_support
