// See kept_frames.h.
#include "src/model/render/kept_frames.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace eventide {

void KeptFrames::make_room(const FrameGeometry& geometry, std::size_t tiles) {
    const std::size_t pixels = std::size_t(geometry.part_width) * std::size_t(geometry.part_height);
    count_ = std::clamp<std::size_t>(kMaxBytes / (2 * pixels * sizeof(float)), 1, kMaxFrames);
    // Two sizes that take turns give no memory back.
    if (frames_.size() < count_) frames_.resize(count_);
    for (KeptFrame& frame : std::span{frames_}.first(count_)) {
        frame.intensity.resize(pixels);
        frame.sigma.resize(pixels);
        frame.tiles.assign(tiles, {});
    }
}

void KeptFrames::reset() noexcept {
    for (KeptFrame& frame : frames_) std::ranges::fill(frame.tiles, KeptFrame::Stamp{});
}

KeptFrame& KeptFrames::choose(const FrameKind& kind, double fraction, double bound) noexcept {
    const auto apart = [&](const KeptFrame& frame) {
        return frame.kind == kind ? std::abs(frame.fraction - fraction) : INFINITY;
    };
    const std::span frames = std::span{frames_}.first(count_);
    KeptFrame* chosen = &*std::ranges::min_element(frames, {}, apart);
    if (apart(*chosen) > bound) chosen = &*std::ranges::min_element(frames, {}, &KeptFrame::used);
    // Of the same kind it keeps its tiles' stamps: what is still true of them saves rendering.
    if (chosen->kind != kind) std::ranges::fill(chosen->tiles, KeptFrame::Stamp{});
    chosen->kind = kind;
    chosen->fraction = fraction;
    chosen->used = ++uses_;
    return *chosen;
}

}  // namespace eventide
