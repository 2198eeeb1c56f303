// Whether a stream's images are told by the clock of its events.
#pragma once

#include "src/core/event.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>

namespace eventide {

/// In files that were put together from parts, the images' clock may be another one than the
/// events': decades lie between times since 1970 and those since a camera was switched on.
class ImageClock {
public:
    /// An image and an event that are neighbours in the stream are never so far apart where one
    /// clock tells both: while an image is taken, something moves or the sensor makes noise.
    static constexpr SensorDuration kFar{60'000'000};

    /// All that the stream holds, in its order; the events of a batch lie close together.
    void see(const Batch& batch) {
        if (!batch.images.empty()) {
            if (event_) compare(batch.images.front().t, *event_);
            image_ = batch.images.back().t;
        }
        if (batch.events.empty()) return;
        event_ = batch.events.back().t;
        if (image_) compare(*image_, *event_);
    }

    /// How far each image was from the events around it, at least; 0 where the clock is the same,
    /// and before there are images and events.
    SensorDuration apart() const {
        return nearest_ && *nearest_ > kFar ? *nearest_ : SensorDuration{0};
    }

private:
    void compare(SensorTime image, SensorTime event) {
        const SensorDuration apart = std::chrono::abs(image - event);
        nearest_ = std::min(nearest_.value_or(apart), apart);
    }

    std::optional<SensorTime> image_, event_;  // the newest
    std::optional<SensorDuration> nearest_;
};

/// What is wrong with images that are apart().
inline std::string image_clock_text(SensorDuration apart) {
    return "expected one clock for images and events, found them at least " +
           std::to_string(apart / std::chrono::seconds{1}) + " s apart";
}

}  // namespace eventide
