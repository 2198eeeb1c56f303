// Puts APS frames together from the ADC samples of a DAVIS (docs/protocols.md A.10).
#pragma once

#include "src/codec/inivation/davis_sensor.h"
#include "src/core/event.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace eventide {

/// One frame at a time. Words of a frame whose start was not seen are ignored.
class DavisFrameAssembler {
public:
    enum class Read : std::uint8_t { reset, signal };
    enum class Shutter : std::uint8_t { global, rolling };
    enum class End : std::uint8_t { none, complete, incomplete };

    explicit DavisFrameAssembler(const DavisSensor& sensor);

    /// True where the frame before did not end: it is lost.
    bool begin(Shutter shutter, SensorTime t);
    void roi_byte(std::uint8_t value);  ///< misc8 kinds 1 and 2
    void column_begin(Read read);
    void sample(std::uint16_t adc, SensorTime t);  ///< 10 bits
    void column_end();
    void exposure_begin(SensorTime t) { exposure_begin_ = t; }

    /// The frame is over. Complete: `into` is filled; incomplete: columns or samples were missing;
    /// none: no frame began.
    End end(SensorTime t, ReferenceImage& into);

    void abandon() { active_ = false; }

private:
    int roi_width() const { return roi_[2] - roi_[0] + 1; }
    int roi_height() const { return roi_[3] - roi_[1] + 1; }
    /// Device axes: what is read out column by column.
    int device_columns() const { return sensor_.aps_swapped ? roi_height() : roi_width(); }
    int device_rows() const { return sensor_.aps_swapped ? roi_width() : roi_height(); }
    void use_roi(int x0, int y0, int x1, int y1);
    std::uint16_t pixel(int column, int row) const;
    void write_image(ReferenceImage& into) const;

    DavisSensor sensor_;
    bool active_ = false;
    Shutter shutter_ = Shutter::global;
    std::array<std::uint8_t, 8> roi_bytes_{};
    int roi_count_ = 0;
    std::array<int, 4> roi_{};  ///< as a person sees it: first x, first y, last x, last y
    Read read_ = Read::reset;
    bool in_column_ = false;
    std::array<int, 2> columns_{};  ///< finished, per read
    int row_ = 0;                   ///< samples of the column so far
    bool short_column_ = false;
    std::array<std::vector<std::uint16_t>, 2> samples_;  ///< per read: [column][row]
    SensorTime exposure_begin_{}, exposure_end_{};
    std::array<bool, 2> sampled_{};  ///< per read: a sample of this frame came
};

}  // namespace eventide
