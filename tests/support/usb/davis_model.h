// A DAVIS in software, register by register: what a driver sees at the other end of the cable.
#pragma once

#include "drivers/usb/davis_registers.h"
#include "src/codec/inivation/davis_sensor.h"
#include "src/core/event.h"
#include "tests/support/usb/davis_writer.h"
#include "tests/support/usb/usb_model.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace eventide::testing_support {

struct DavisModelSettings {
    DavisSensor sensor;
    std::string serial = "00000042";
    std::uint16_t product = 0x841A;  ///< behind FX3
    std::uint8_t firmware = 6, board_type = 3;
    std::uint32_t logic = 18, patch = 1;
    bool dvs_statistics = true, mux_statistics = true;  ///< whether the logic says it has them
    /// Of the camera's own memory for words that nobody fetches; 0: endless. Events that find no
    /// room are dropped and counted (MUX 83); images and IMU samples wait.
    std::size_t fifo_bytes = 0;
    /// Applied to the words of each stretch of the stream before they are sent: where faults are
    /// made.
    std::function<void(std::vector<std::byte>&)> spoil;
    /// Real time, from any beginning: nothing later than the time since the timestamp reset is
    /// sent, and in silence its wraps are. Empty: the scene goes by as fast as it is fetched.
    std::function<SensorTime()> now;
};

/// Registers, and the stream they let flow; those that such a camera has not got read 0 whatever is
/// written to them. Words come out only while MUX run, timestamp run and
/// USB run are 1; events only with DVS run and chip run, images only with APS run, IMU samples only
/// with its accelerometer on. Time begins with timestamp run, and nothing else is needed.
///
/// The scene is what would be lost on a driver that has not yet switched on all it wants, so it
/// begins when the driver has: at a timestamp reset, which drops what was queued, sends the marker
/// and starts the scene anew; without one, when something that sees is on and data were asked for
/// kSettled times since the last register was written.
///
/// Thread: one at a time; the testbed locks.
class DavisModel final : public UsbModel {
public:
    static constexpr int kSettled = 500;  ///< requests; 50 ms through the testbed

    explicit DavisModel(DavisModelSettings settings);

    /// What the camera will see, in time order; the first thing is seen at the time it says after a
    /// timestamp reset.
    void show(Batch scene);

    const DavisModelSettings& settings() const { return settings_; }
    std::uint32_t read(davis::Register at) const;
    void write(davis::Write write);
    const std::vector<davis::Write>& writes() const { return writes_; }  ///< all, in order
    bool is_streaming() const;

    UsbModelIdentity identity() const override;
    int control(const UsbSetup& setup, std::span<std::uint8_t> data) override;
    std::size_t send(std::span<std::byte> out) override;
    void clear_endpoint() override;

    bool is_scene_over() const;  ///< and its last word was fetched
    std::uint64_t bytes_sent() const { return bytes_sent_; }

private:
    bool has(davis::Register at) const;
    bool is_too_early_for_part_of_a_packet(std::size_t queued);
    SensorTime now() const;
    void begin_time();
    void begin_scene(SensorDuration after);
    bool sees_something() const;
    void make_more(std::size_t bytes);
    SensorTime end_of_stretch(std::size_t events, SensorTime clock) const;
    Batch next_stretch(SensorTime until);
    void drop_what_finds_no_room(std::vector<Event>& events);

    DavisModelSettings settings_;
    std::map<davis::Register, std::uint32_t> registers_;
    std::vector<davis::Write> writes_;
    Batch scene_;
    std::size_t event_ = 0, image_ = 0, imu_ = 0, trigger_ = 0;  ///< next of the scene
    std::size_t full_buffers_ = 0;  ///< of those that no transfer has taken yet
    SensorTime waits_since_{};      ///< the buffer that is not full
    SensorTime time_began_{};       ///< on settings_.now
    SensorDuration scene_began_{};  ///< after that
    bool scene_runs_ = false;
    int asked_ = 0;  ///< for data, since the last write
    std::unique_ptr<DavisWriter> writer_;
    std::vector<std::byte> words_;
    std::size_t sent_ = 0;  ///< of words_
    std::uint64_t bytes_sent_ = 0;
};

}  // namespace eventide::testing_support
