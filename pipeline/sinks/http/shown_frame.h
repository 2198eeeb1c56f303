// A frame on its way to viewers, with what they ask for made once for all of them.
#pragma once

#include "pipeline/sinks/draw_frame.h"
#include "src/core/frame_data.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace eventide {

/// What a stream of images shows.
enum class Show { intensity, sigma, side, overlay };

/// "intensity", "sigma", "side", "overlay"; empty for other words.
std::optional<Show> parse_show(std::string_view word);

/// Never changes. Its encodings are made when first asked for, by whoever asks. Thread: any.
class ShownFrame {
public:
    using Bytes = std::vector<unsigned char>;

    /// `latency` is from the newest events the frame saw until it was copied.
    ShownFrame(Frame frame, float sigma_white, std::chrono::nanoseconds latency);

    const Frame& frame() const { return frame_; }
    std::chrono::nanoseconds latency() const { return latency_; }
    /// Returns the memory for another frame; called by the last holder.
    Frame take_frame() { return std::move(frame_); }

    // Throw Error (failed) where the encoder does; jpeg() of sigma of a frame without is black.
    const Bytes& jpeg(Show show) const;
    const Bytes& png(Show show) const;  ///< exact
    const Bytes& tiff() const;          ///< sigma, 32-bit floats; empty where the frame has none
    const Bytes& events()
        const;  ///< PNG of bytes: 0 off, 128 none, 255 on; empty without a preview
    /// What the live page is sent: a head and the images behind it, as page.js reads them.
    const Bytes& message() const;

private:
    struct Made {
        std::once_flag once;
        Bytes bytes;
    };
    const Bytes& made(Made& made, const std::function<void(Bytes&)>& make) const;

    Frame frame_;
    const float sigma_white_;
    const std::chrono::nanoseconds latency_;
    mutable Made jpegs_[4], pngs_[4], tiff_, events_, message_;
};

}  // namespace eventide
