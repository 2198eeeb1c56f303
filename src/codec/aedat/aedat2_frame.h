// APS frames of AEDAT 2.0: two reads of each pixel, without a word that says where a frame begins.
#pragma once

#include "src/core/array.h"
#include "src/core/damage.h"
#include "src/core/event.h"

#include <cstdint>
#include <optional>

namespace eventide {

/// Collects reset and signal reads until every pixel has both, or a pixel is read again: that is
/// the next frame. The pixel is their difference (correlated double sampling). Frames of a region
/// (ROI) are complete when their reads fill a rectangle.
///
/// Exposure, from the order of reads: with a global shutter all resets come before all signals, and
/// it lasts from the last reset to the first signal; with a rolling one it begins with the first
/// reset.
class Aedat2FrameAssembler {
public:
    Aedat2FrameAssembler(int width, int height, bool is_davis240);

    /// x, y in image coordinates, inside the sensor; `sample` of 10 bits.
    void read(bool is_signal, int x, int y, std::uint16_t sample, SensorTime t, Batch& into,
              Damage& damage);
    /// A region is complete at the end of the stream when the frame before had the same one.
    void finish(Batch& into, Damage& damage);
    void drop();

private:
    struct Box {
        int x0, y0, x1, y1;  ///< px, all included
        int area() const { return (x1 - x0 + 1) * (y1 - y0 + 1); }
        friend bool operator==(const Box&, const Box&) = default;
    };
    bool is_complete() const;
    void emit(Batch& into);

    bool is_davis240_;
    Array2<std::uint16_t> reset_, signal_;  ///< [y][x], the sample plus one; 0 where not read yet
    int resets_ = 0, signals_ = 0;
    Box box_{};
    std::optional<Box> last_box_;  ///< of the frame before
    SensorTime first_reset_{}, last_reset_{}, first_signal_{};
    bool rolling_ = false;  ///< a reset came after a signal
};

}  // namespace eventide
