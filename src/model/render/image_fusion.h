// A camera's own images beside its events: what they show that the network missed is added to every
// frame, moves with the scene, and is kept for as long as it holds.
#pragma once

#include "src/core/frame_data.h"
#include "src/model/render/followed_image.h"
#include "src/model/render/past_events.h"
#include "src/model/render/renderer.h"
#include "src/model/render/residual_pyramid.h"

#include <array>
#include <cstdint>
#include <vector>

namespace eventide {

/// Two neighbours along one axis, and the weight of the second.
struct LinearTap {
    int first = 0, second = 0;
    float weight = 0;
};

/// In the order of event windows: advance(), then correct() for each image that came, then apply()
/// to the window's frames or to those of the two before. One thread at a time; nothing is allocated
/// after construction, nothing fails.
///
/// The last image follows the scene: at each window's end, optical flow between what the model
/// shows then and what it showed when the image was taken says where each pixel was in the image,
/// within a window what lies between the flow at its edges. The image, so displaced, less what the
/// model shows is what is added, as far as the bands of a ResidualPyramid still hold.
///
/// Where an image comes within a window the correction goes over linearly from the one that was,
/// from the window's begin to the image's time, so that an image does not make frames jump. One
/// from before the first window corrects it from its begin on.
///
///     event windows    n - 3  |  n - 2  |  n - 1  |  n  |
///     expected_        at each of these four ends, that of window n in slot n % 4
///     apply()                 (- in any of these three: from one end to the next -)
class ImageFusion {
public:
    ImageFusion(int sensor_width, int sensor_height);

    void reset() noexcept;

    /// Call it before the first advance() where there were event windows before it: what is known
    /// at its begin is not what is known where a stream begins.
    void begin_within_stream() noexcept { windows_ = 1; }

    /// The next event window, its events per pixel, [y][x] of the sensor, and what the model shows
    /// at its end, at the sensor's size; where that is not known, nothing is taken to have moved.
    void advance(const Window& window, const Array2<float>& events, const Frame* at_end) noexcept;

    /// An image of the sensor, and what the model shows at that time (or as soon after it as it
    /// can), at the sensor's size. Of the part that the image covers. Images of times after the
    /// newest window's end, and those older than kRemembered before it, tell nothing; false for
    /// these.
    bool correct(const ReferenceImage& image, const Frame& rendered) noexcept;

    /// Corrects `frame`, which was rendered for `request` at a frame.t within one of the last three
    /// windows. `shown`: what the model shows at that time, at the sensor's size; it may be the
    /// frame's own intensity as rendered. The last prepare() was for requests of this geometry.
    void apply(const RenderRequest& request, const Array2<float>& shown, Frame& frame) noexcept;

    /// The memory that apply() needs for frames of this size and region.
    void prepare(const RenderRequest& request);

    static constexpr SensorDuration kRemembered = PastEvents::kRemembered;

private:
    /// At the end of a window.
    struct Expected {
        Window window{};
        Array2<float> correction, variance;
        MotionField since_before;  // what is at x was at x + this at the end of the window before
        MotionField through;       // the same, by the motion since a new image was taken
        bool followed = false;     // it is known how things moved
        bool new_image = false;    // an image came
        float whole_from = 1;      // where in the window it counts whole, 1 at the end
    };
    const Expected& at_end_of(std::uint64_t window) const;
    void pass_window() noexcept;
    void begin_with(const ReferenceImage& image, const Array2<float>& shown) noexcept;
    void spread_motion(SensorTime t, Expected& now) noexcept;
    void come_in(SensorTime t, Expected& now) const noexcept;
    void know(const Array2<float>& shown, const MotionField& since_before) noexcept;
    void expect(Expected& expected) noexcept;
    void expect_at_end() noexcept;
    void correct_within(std::uint64_t window, float at, float weight,
                        const Array2<float>& shown) noexcept;
    void mix_ends(float at, float weight, const Expected& before, const Expected& after) noexcept;
    void row_before(const Expected& before, const Expected& after, float at, int y) noexcept;
    std::size_t slot_of(std::uint64_t window) const {
        return std::size_t(window % expected_.size());
    }
    Expected& newest() { return expected_[slot_of(windows_)]; }

    int width_, height_;
    ResidualPyramid pyramid_;
    FollowedImage image_;
    PastEvents past_;
    std::uint64_t windows_ = 0;         // so many came
    std::array<Expected, 4> expected_;  // that of window n at n % 4
    Array2<float> shown_;               // at the newest window's end
    bool knows_shown_ = false;
    Array2<float> residual_;                      // there
    Array2<float> trust_, since_;                 // scratch
    Array2<float> residual_within_, correction_;  // of the frame at hand
    std::vector<float> row_, dx_, dy_;            // at the sensor's columns
    std::vector<LinearTap> columns_;              // of the frames that apply() saw last
    int out_width_ = 0, first_column_ = 0;
};

}  // namespace eventide
