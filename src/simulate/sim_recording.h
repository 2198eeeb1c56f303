// A simulated recording: events, reference images and truth, in the order a camera would give them.
#pragma once

#include "src/simulate/presets.h"
#include "src/simulate/scene/textures.h"
#include "src/simulate/simulated_stream.h"

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace eventide {

struct SimRecordingSettings {
    SceneSettings scene;
    SensorSettings sensor;
    int width = 240, height = 180;  ///< px
    std::uint64_t seed = 1;
    double seconds = 4;             ///< up to 1e9; 0: without end
    double images_per_second = 25;  ///< reference images of the sensor's size; 0: none
    double truths_per_second = 0;   ///< truth beside them, of `truth_scale` times the size; 0: none
    double truth_scale = 1;         ///< (width - 1) scale + 1 columns: corners stay corners
    SensorTime begin{};             ///< what the recording's first microsecond is called
    SensorDuration chunk{10000};    ///< longest time in one batch
};

/// The image at one instant, [y][x] in [0, 1].
struct Truth {
    SensorTime t{};
    Array2<float> image;
};

class SimRecording {
public:
    /// Throws Error (usage) for settings out of range.
    SimRecording(const SimRecordingSettings& settings,
                 std::shared_ptr<const TextureLibrary> textures);

    /// Replaces `batch` and `truths` by the data of the next chunk; false when the recording is
    /// over. The images of `begin` come alone, before the first event; the others in the batch that
    /// ends at their time.
    bool next(Batch& batch, std::vector<Truth>& truths);

    SensorTime now() const { return stream_.now() + offset_; }  ///< end of the latest chunk

private:
    /// Instants at equal rate from 0 on.
    struct Ticks {
        double per_second = 0;
        std::int64_t number = 0;
        std::optional<SensorTime> next() const;
    };
    bool due(Ticks& ticks) const;
    Array2<float> view(double scale) const;

    SimRecordingSettings settings_;
    SimulatedStream stream_;
    SensorDuration offset_;
    Ticks images_, truths_;
};

/// All batches of a recording, one after the other; emit() returns false to stop early.
void simulate_recording(const SimRecordingSettings& settings,
                        std::shared_ptr<const TextureLibrary> textures,
                        const std::function<bool(const Batch&, const std::vector<Truth>&)>& emit);

/// An image in [0, 1] as a reference image, clipped, of 16 bits.
ReferenceImage reference_image(SensorTime t, const Array2<float>& view);

}  // namespace eventide
