// data -> DAVIS USB words: what the software camera sends, and the inverse that the parser is
// tested with.
#pragma once

#include "src/codec/inivation/davis_sensor.h"
#include "src/core/event.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace eventide::testing_support {

/// The words of one camera. Times are microseconds since the camera's timestamp reset and must not
/// step back within or between batches; an image's words go out in two parts, at exposure_begin and
/// at exposure_end, so an image has to come in the batch that holds (or before the ones that hold)
/// the events of its exposure.
///
/// What the wire cannot hold: pixels beyond 10 bits are cut, IMU values are rounded to +-4 g and
/// +-500 deg/s over 16 bits, there is no magnetometer, images are grey and lie wholly in the
/// sensor.
class DavisWriter {
public:
    explicit DavisWriter(const DavisSensor& sensor) : sensor_(sensor) {}

    /// The marker that comes before anything else where the camera's time was reset.
    static void timestamp_reset(std::vector<std::byte>& out);
    void write(const Batch& batch, std::vector<std::byte>& out);

    /// Moves the camera's clock without data: the wrap words that a silent camera sends.
    void advance(SensorTime t, std::vector<std::byte>& out) { time_word(to_us(t), out); }

    SensorTime time() const { return from_us(time_); }  ///< said last

private:
    void time_word(std::int64_t t, std::vector<std::byte>& out);
    void event(const Event& event, std::vector<std::byte>& out);
    void image_reset(const ReferenceImage& image, std::vector<std::byte>& out);
    void image_signal(const ReferenceImage& image, std::vector<std::byte>& out);
    void columns(const ReferenceImage& image, bool signal, std::vector<std::byte>& out) const;
    void imu(const ImuSample& sample, std::vector<std::byte>& out);
    void trigger(const Trigger& trigger, std::vector<std::byte>& out);

    DavisSensor sensor_;
    std::int64_t wrap_add_ = 0, time_ = 0;  ///< us
    bool time_sent_ = false;                ///< the first time word goes out even for time 0
    int y_ = -1;                            ///< row address sent last
};

}  // namespace eventide::testing_support
