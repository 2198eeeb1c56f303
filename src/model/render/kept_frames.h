// Frames that were rendered before, tile by tile with what they were made of, so that a tile whose
// inputs are those of then is copied and not rendered again.
#pragma once

#include "src/model/model_config.h"
#include "src/model/render/sampling.h"

#include <cstdint>
#include <vector>

namespace eventide {

/// What a frame is made of besides codes and the place within the event window: two frames of
/// different kinds have nothing in common.
struct FrameKind {
    FrameGeometry geometry;
    SigmaRule rule{};
    bool has_sigma = false;
    CodesRead read;  ///< the oldest of them also says which samples in time
    friend bool operator==(const FrameKind&, const FrameKind&) = default;
};

struct KeptFrame {
    /// When a tile was rendered: in event window k (0: never), at `fraction` of it. A tile that
    /// stands in for a later one keeps its fraction, so that nothing drifts.
    struct Stamp {
        std::int64_t k = 0;
        double fraction = 0;
    };
    FrameKind kind;
    double fraction = -1;                 ///< of the newest frame it was used for
    std::vector<float> intensity, sigma;  ///< [y][x] of the wanted part
    std::vector<Stamp> tiles;
    std::uint64_t used = 0;  ///< counts up; the smallest was used longest ago
};

/// As many frames as fit into kMaxBytes, at least one and at most kMaxFrames: a rate of frames
/// that divides the event window's comes back to the same few places in it.
///
///     whole frame    240x180    640x480    1280x720
///     frames         16         6          2           two maps of float32 each
class KeptFrames {
public:
    static constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
    static constexpr std::size_t kMaxFrames = 16;

    /// Memory for frames of this size, `tiles` tiles each. What was kept before is forgotten.
    void make_room(const FrameGeometry& geometry, std::size_t tiles);
    void reset() noexcept;

    /// The frame nearest to `fraction` of those of this kind, where there is one within `bound`;
    /// else the one used longest ago, whose tiles may all be out of date.
    KeptFrame& choose(const FrameKind& kind, double fraction, double bound) noexcept;

private:
    std::vector<KeptFrame> frames_;  // the first count_ of them
    std::size_t count_ = 0;
    std::uint64_t uses_ = 0;
};

}  // namespace eventide
