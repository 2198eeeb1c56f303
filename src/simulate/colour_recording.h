// A simulated colour camera: three scenes that differ in their colour alone, seen through one
// filter.
#pragma once

#include "src/core/bayer.h"
#include "src/simulate/sim_recording.h"

#include <array>
#include <memory>
#include <vector>

namespace eventide {

/// As SimRecording; the pixels of each colour see the scene of theirs.
class ColourRecording {
public:
    /// Blue, green, red.
    using Textures = std::array<std::shared_ptr<const TextureLibrary>, 3>;
    using Truths = std::array<std::vector<Truth>, 3>;

    /// The textures are the same images, in one colour each. Throws Error (usage) for settings out
    /// of range.
    ColourRecording(const SimRecordingSettings& settings, const Textures& textures,
                    ColourFilter filter);

    /// Images are mosaics. Truths of the three colours are alike in time and size.
    bool next(Batch& batch, Truths& truths);

private:
    void take_events(const Batch& part, ColourChannel channel, Batch& batch);

    ColourFilter filter_;
    std::vector<SimRecording> colours_;
};

}  // namespace eventide
