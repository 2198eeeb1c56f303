// Keeps APS frames well exposed: looks at frames where they are parsed, and tells the source
// thread.
#pragma once

#include "src/codec/inivation/davis.h"

#include <atomic>
#include <memory>

namespace eventide {

/// The exposure that would put the frame's mean where it should be, us; `current_us` where it
/// already is. Steps are limited to a factor of 2 up and 4 down, and a frame that is mostly
/// saturated goes down by 4, because its mean says nothing.
int better_exposure_us(const ReferenceImage& frame, int current_us);

/// What the bin thread says and the source thread does. 0: nothing to do.
using ExposureRequest = std::atomic<int>;

/// A DavisParser that also looks at the frames' brightness. The exposure asked for is written to
/// the camera by the source thread, so that no control request ever waits inside event handling.
class ExposingDavisParser final : public Parser {
public:
    ExposingDavisParser(const DavisSensor& sensor, int exposure_us,
                        std::shared_ptr<ExposureRequest> request)
        : parser_(sensor), exposure_us_(exposure_us), request_(std::move(request)) {}

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override { parser_.finish(into); }
    void resync() override { parser_.resync(); }
    void arrives(HostTime at) override { parser_.arrives(at); }
    std::optional<SensorTime> clock() const override { return parser_.clock(); }
    const Damage& damaged() const override { return parser_.damaged(); }

private:
    /// A new exposure shows two frames later: one is being read, one is being exposed.
    static constexpr int kFramesUntilItShows = 2;

    DavisParser parser_;
    int exposure_us_;
    int wait_frames_ = 0;
    std::shared_ptr<ExposureRequest> request_;
};

}  // namespace eventide
