// See scene_windows.h.
#include "apps/bench/scene_windows.h"

#include "src/simulate/scene/textures.h"

namespace eventide::bench {
namespace {

constexpr SensorDuration kWindow{50'000}, kLeftOut{200'000};
constexpr int kTextures = 25;

}  // namespace

std::vector<SceneWindow> scene_windows(const SimRecordingSettings& settings, int count) {
    SimulatedStream stream{settings.scene, settings.sensor, procedural_textures(kTextures),
                           settings.width, settings.height, settings.seed};
    SensorTime now = stream.now() + kLeftOut;
    std::vector<Event> before;
    stream.advance(now, before);
    std::vector<SceneWindow> windows(static_cast<std::size_t>(count));
    for (SceneWindow& window : windows) {
        window.window = {now, now + kWindow};
        now += kWindow;
        stream.advance(now, window.events);
    }
    return windows;
}

}  // namespace eventide::bench
