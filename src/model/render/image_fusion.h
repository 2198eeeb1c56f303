// A camera's own images beside its events: what they show that the network missed is added to every
// frame, for as long as it holds.
#pragma once

#include "src/core/frame_data.h"
#include "src/model/render/renderer.h"
#include "src/model/render/residual_pyramid.h"

#include <array>
#include <cstdint>
#include <vector>

namespace eventide {

/// Where intensity lies between these, the image is neither black nor saturated.
inline constexpr float kDarkest = .02F, kBrightest = .98F;

/// Two neighbours along one axis, and the weight of the second.
struct LinearTap {
    int first = 0, second = 0;
    float weight = 0;
};

/// In the order of event windows: advance(), then correct() for each image that came, then apply()
/// to the window's frames or to those of the two before. One thread at a time; nothing is allocated
/// after construction, nothing fails.
///
/// Between the edges of a window the correction goes over linearly from what it was at the end of
/// the window before to what it is now, so that an image does not make frames jump.
///
///     event windows    n - 3  |  n - 2  |  n - 1  |  n  |
///     expected_        at each of these four ends, that of window n in slot n % 4
///     apply()                 (- in any of these three: from one end to the next -)
class ImageFusion {
public:
    ImageFusion(int sensor_width, int sensor_height);

    void reset() noexcept;

    /// The next event window, and its events per pixel, [y][x] of the sensor.
    void advance(const Window& window, const Array2<float>& events) noexcept;

    /// An image of the sensor, and what the model shows at that time (or as near as it can), at the
    /// sensor's size. Of the part that the image covers. Images of times after the newest window's
    /// end, and those older than kRemembered before it, tell nothing; false for these.
    bool correct(const ReferenceImage& image, const Frame& rendered) noexcept;

    /// To a frame as it was rendered for `request`, at frame.t within one of the last three
    /// windows.
    /// prepare() was called for requests of this geometry last.
    void apply(const RenderRequest& request, Frame& frame) noexcept;

    /// The memory that apply() needs for frames of this size and region.
    void prepare(const RenderRequest& request);

    static constexpr SensorDuration kRemembered{200'000};

private:
    struct Expected {
        Window window{};
        Array2<float> correction, variance;  // at its end
    };
    /// Events per pixel of some time, so that an image that comes late can be told what came since.
    struct Past {
        Window window{};
        Array2<float> events;
    };
    void remember(const Window& window, const Array2<float>& events) noexcept;
    void collect_since(SensorTime t) noexcept;
    const Expected& at_end_of(std::uint64_t window) const;
    static void mix_row(const Array2<float>& before, const Array2<float>& after, float at,
                        const LinearTap& y, std::vector<float>& row) noexcept;
    Expected& newest() { return expected_[std::size_t(windows_ % 4)]; }

    int width_, height_;
    ResidualPyramid pyramid_;
    std::uint64_t windows_ = 0;         // so many came
    std::array<Expected, 4> expected_;  // that of window n at n % 4
    // A ring: the newest slot is filled until it is 18.2 ms wide, then the oldest begins anew.
    std::array<Past, 12> past_;
    std::size_t past_newest_ = 0;
    Array2<float> residual_, trust_, since_;
    std::vector<float> row_;          // scratch of apply(), at the sensor's columns
    std::vector<LinearTap> columns_;  // of the frames that apply() saw last
    int out_width_ = 0, first_column_ = 0;
};

}  // namespace eventide
