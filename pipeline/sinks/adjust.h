// What users may change about an image before it is shown: range, sharpness, side, border.
#pragma once

#include "pipeline/sinks/changing_sink.h"

#include <memory>
#include <string_view>
#include <vector>

namespace eventide {

enum class Flip { none, horizontal, vertical, both };

std::string_view name_of(Flip flip);

/// Off by default, because each of them changes the numbers.
struct AdjustSettings {
    bool auto_hdr = false;  ///< stretch the range the image uses to black..white
    float unsharp = 0;      ///< 0 off; 0.3 is E2VID's. How much of the fine detail is added again
    Flip flip = Flip::none;
    int crop_px = 0;  ///< output pixels cut off at each of the four sides

    bool changes_nothing() const;
};

/// The range an image uses, smoothed over sensor time so that it does not flicker.
class AutoRange {
public:
    struct Range {
        float low = 0, high = 1;
    };

    /// Shares of pixels below and above the range: single bright pixels do not darken an image.
    static constexpr double kBelow = 0.01, kAbove = 0.01;
    /// A flat image is not stretched until its noise fills the range.
    static constexpr float kNarrowest = 0.1f;
    /// Time constant of the smoothing, whatever the frame rate.
    static constexpr double kSeconds = 0.5;

    Range update(SensorTime t, const Array2<float>& intensity);

private:
    Range smooth_;
    /// Sum of the weights of the frames that smooth_ is the mean of: small at first, so that the
    /// first frame, of a network that has seen little, does not stand for half a second.
    double weight_ = 0;
    SensorTime last_{};
    bool begun_ = false;
};

/// Applies the settings in this order: crop, flip, auto HDR, unsharp. sigma is cropped, flipped and
/// scaled with intensity, so that it stays in its units; unsharp leaves it alone. An event preview
/// is flipped.
class Adjustment {
public:
    explicit Adjustment(AdjustSettings settings) : settings_{settings} {}

    /// The changed frame, borrowed until the next call. Throws Error (usage) when the crop leaves
    /// nothing.
    const Frame& apply(const Frame& frame);

private:
    void stretch();
    void sharpen();

    AdjustSettings settings_;
    AutoRange range_;
    Frame shown_;
};

class AdjustSink final : public ChangingSink {
public:
    AdjustSink(AdjustSettings settings, std::vector<std::unique_ptr<Sink>> behind);

private:
    const Frame& changed(const Frame& frame) override { return adjust_.apply(frame); }

    Adjustment adjust_;
};

}  // namespace eventide
