// A simulated camera before a simulated scene: events, and the truth at any time, place and
// resolution.
#pragma once

#include "src/core/array.h"
#include "src/core/event.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace eventide {

struct SceneSettings;  // scene_settings.h: textures, objects, motion, pauses, illumination, flicker
struct SensorSettings;  // sensor_settings.h: thresholds, mismatch, low-pass, leak, shot noise,
                        // refractory, hot pixels, jitter
class TextureLibrary;   // textures.h: a folder or pack of images, or procedural; read only, any
                        // thread

/// A sensor that is a part of a larger one: objects, motion and exposure are of the whole, as they
/// would be if it were simulated and cut afterwards. Exposure is what matters: a part of an image
/// may be all dark or all bright, and a whole never is.
struct SensorPart {
    int width = 0, height = 0;              ///< px, of the part; at least 2
    int x0 = 0, y0 = 0;                     ///< px, its first pixel in the whole
    int whole_width = 0, whole_height = 0;  ///< px
    static SensorPart all(int width, int height) { return {width, height, 0, 0, width, height}; }
};

/// Deterministic by seed. One at a time; streams are independent, so that many run on many threads.
class SimulatedStream {
public:
    /// Draws one scene and one sensor from the settings' ranges. Sensor of width x height px.
    SimulatedStream(const SceneSettings& scene, const SensorSettings& sensor,
                    std::shared_ptr<const TextureLibrary> textures, int width, int height,
                    std::uint64_t seed);
    /// Throws Error(usage) where the part does not lie in the whole.
    SimulatedStream(const SceneSettings& scene, const SensorSettings& sensor,
                    std::shared_ptr<const TextureLibrary> textures, const SensorPart& part,
                    std::uint64_t seed);
    ~SimulatedStream();
    SimulatedStream(SimulatedStream&&) noexcept;
    SimulatedStream& operator=(SimulatedStream&&) noexcept;

    SensorTime now() const;

    /// Sub-frames computed so far; times width x height these are the pixel-steps of its speed.
    std::uint64_t sub_frames() const;

    /// Appends the events in (now(), end], in time order, and moves on to `end`.
    void advance(SensorTime end, std::vector<Event>& events);

    /// The image an ideal camera shows at t (its exposure follows the scene), intensity [y][x] in
    /// [0, 1], of size out.height() x out.width(), align-corners over the region [y0, y0 +
    /// span_y] x [x0, x0 + span_x] in px. t must lie in the current or previous advance() step's
    /// span, or be now().
    void truth(SensorTime t, double y0, double x0, double span_y, double span_x,
               Array2<float>& out) const;

    /// truth() over the whole sensor.
    void truth(SensorTime t, Array2<float>& out) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace eventide
