// The last image of the camera, displaced to where things are now.
#pragma once

#include "src/core/event.h"
#include "src/model/render/patch_flow.h"

#include <span>
#include <vector>

namespace eventide {

/// Where intensity lies between these, the image is neither black nor saturated.
inline constexpr float kDarkest = .02F, kBrightest = .98F;

/// Row y of a motion field, at the frames' columns, so many times: adds it.
void add_motion_row(const MotionField& motion, int y, float times, std::span<float> dx,
                    std::span<float> dy) noexcept;

/// Row y of a map, each pixel from where it is when displaced: [y + dy][x + dx], bilinear, beyond
/// the edge the edge's.
void displaced_row(const Array2<float>& map, int y, std::span<const float> dx,
                   std::span<const float> dy, std::span<float> row) noexcept;

/// One thread at a time; nothing is allocated after construction, nothing fails. Maps are [y][x] of
/// the sensor.
class FollowedImage {
public:
    FollowedImage(int sensor_width, int sensor_height);

    void reset() noexcept;
    bool there() const { return there_; }

    /// A new image instead of the last: the scene as it has it, where it tells something; elsewhere
    /// what the model showed when it was taken, and what was added to that. `trust`: 1 where it
    /// tells something, else 0. `since`: events per pixel that have come since it was taken.
    void take(const ReferenceImage& image, const Array2<float>& shown,
              const Array2<float>& correction, const Array2<float>& since,
              Array2<float>& trust) noexcept;

    /// Time passes: events per pixel.
    void pass(const Array2<float>& events) noexcept;

    /// Aligns the image with `shown`, what the model shows now, starting from the previous
    /// alignment. `since_before` becomes the motion since then: what is at x now was at x + this.
    void follow(const Array2<float>& shown, MotionField& since_before) noexcept;
    /// The same for the first time after take(): there is no alignment yet.
    void follow(const Array2<float>& shown) noexcept;

    /// The alignment: what follow() found at x is at x + this in the image.
    const MotionField& motion() const { return motion_; }

    /// How far, 0 to 1, the aligned image tells something of what was shown at the last follow().
    void tell_trust(Array2<float>& trust) noexcept;

    /// The displaced image less `shown`; 0 where no image has been. `back` says for when: 0 at the
    /// last follow(), 1 at the one before it, and between them `since_before` in proportion.
    void residual(const Array2<float>& shown, const MotionField& since_before, float back,
                  Array2<float>& residual) noexcept;

private:
    int width_, height_;
    bool there_ = false, covers_all_ = false;
    Array2<float> image_, then_;  // and what the model showed when it was taken
    Array2<float> covered_;       // 1 where an image has been, else 0
    Array2<float> events_;        // per pixel, since it was taken
    PatchFlow flow_;
    MotionField motion_;  // to where the image has what is there now
    std::vector<float> dx_, dy_, row_;
};

}  // namespace eventide
