// Ties a scene, a sensor and a camera to one clock.
#include "src/simulate/simulated_stream.h"

#include "src/core/error.h"
#include "src/simulate/scene/scene.h"
#include "src/simulate/sensor/event_sensor.h"
#include "src/simulate/sensor/exposure.h"
#include "src/simulate/sensor/readout.h"

#include <algorithm>
#include <cmath>

namespace eventide {

namespace {

double seconds(SensorTime t) {
    return double(to_us(t)) * 1e-6;
}

const SensorPart& checked(const SensorPart& part) {
    const auto inside = [](int from, int size, int whole) {
        return from >= 0 && size >= 2 && from + size <= whole;
    };
    if (inside(part.x0, part.width, part.whole_width) &&
        inside(part.y0, part.height, part.whole_height))
        return part;
    throw Error(ErrorKind::usage,
                "a simulated sensor of " + std::to_string(part.width) + " x " +
                    std::to_string(part.height) + " pixels at (" + std::to_string(part.x0) + ", " +
                    std::to_string(part.y0) + ") does not lie in one of " +
                    std::to_string(part.whole_width) + " x " + std::to_string(part.whole_height));
}

}  // namespace

/// Sub-frames lie on a grid that only the scene decides, so that it does not matter how advance()
/// is cut: events of the last sub-frame that are beyond its end wait in `ready`.
struct SimulatedStream::Parts {
    Parts(const SceneSettings& scene_settings, const SensorSettings& sensor_settings,
          std::shared_ptr<const TextureLibrary> textures, const SensorPart& part, Random random)
        : target(scene_settings.target),
          longest_step_s(scene_settings.step_s.high),
          scene(scene_settings, std::move(textures), part.whole_width, part.whole_height,
                random.fork()),
          exposure(scene_settings, random.fork()),
          sensor(SensorTraits::draw(sensor_settings, random), part.width, part.height,
                 random.fork()),
          readout(sensor.traits(), std::size_t(part.width) * std::size_t(part.height),
                  random.fork()),
          to_scene(Affine::translation(part.x0, part.y0)),
          is_part(part.width < part.whole_width || part.height < part.whole_height),
          to_meter(Affine::scale((part.whole_width - 1) / (kMeterWidth - 1.0),
                                 (part.whole_height - 1) / (kMeterHeight - 1.0))),
          light(part.height, part.width),
          whole_light(kMeterHeight, kMeterWidth) {
        scene.prepare(2 * longest_step_s);
        look(SensorTime{});
        sensor.settle(light, scene.gain(0) * scene.flicker(0));
    }

    void look(SensorTime t) {
        const double t_s = seconds(t);
        scene.render(t_s, to_scene, Scene::Show::light, light);
        if (!exposure.due(t_s)) return;
        if (is_part) scene.render(t_s, to_meter, Scene::Show::light, whole_light);
        exposure.meter(t_s, is_part ? whole_light : light, scene.gain(t_s));
    }

    void sub_frame() {
        const double t_s = seconds(reached);
        scene.prepare(t_s + 2 * longest_step_s);
        const auto us = std::max<std::int64_t>(1, std::int64_t(scene.step(t_s) * 1e6));
        const SensorTime next = reached + SensorDuration{us};
        look(next);
        events.clear();
        sensor.step(reached, next, light, scene.gain(seconds(next)) * scene.flicker(seconds(next)),
                    events);
        readout.take(reached, next, events, ready);
        reached = next;
        ++sub_frames;
    }

    // What the whole's exposure is metered on: fine enough for its contrast.
    static constexpr int kMeterWidth = 64, kMeterHeight = 48;

    TargetRule target;
    double longest_step_s;
    Scene scene;
    Exposure exposure;
    EventSensor sensor;
    Readout readout;
    Affine to_scene;  // the sensor's pixels -> the scene's
    bool is_part;
    Affine to_meter;      // pixels of `whole_light` -> the scene's
    Array2<float> light;  // lux at `reached`, without the scene's gain
    Array2<float> whole_light;
    std::vector<Event> events;  // of one sub-frame
    std::vector<Event> ready;   // in order, beyond now
    std::uint64_t sub_frames = 0;
    SensorTime reached{};          // end of the last sub-frame
    SensorTime now{}, previous{};  // ends of the latest two steps
};

SimulatedStream::SimulatedStream(const SceneSettings& scene, const SensorSettings& sensor,
                                 std::shared_ptr<const TextureLibrary> textures, int width,
                                 int height, std::uint64_t seed)
    : SimulatedStream(scene, sensor, std::move(textures), SensorPart::all(width, height), seed) {}

SimulatedStream::SimulatedStream(const SceneSettings& scene, const SensorSettings& sensor,
                                 std::shared_ptr<const TextureLibrary> textures,
                                 const SensorPart& part, std::uint64_t seed)
    : parts_(std::make_unique<Parts>(scene, sensor, std::move(textures), checked(part),
                                     Random{seed})) {}

SimulatedStream::~SimulatedStream() = default;
SimulatedStream::SimulatedStream(SimulatedStream&&) noexcept = default;
SimulatedStream& SimulatedStream::operator=(SimulatedStream&&) noexcept = default;

SensorTime SimulatedStream::now() const {
    return parts_->now;
}

std::uint64_t SimulatedStream::sub_frames() const {
    return parts_->sub_frames;
}

void SimulatedStream::advance(SensorTime end, std::vector<Event>& events) {
    Parts& p = *parts_;
    if (end < p.now)
        throw Error(ErrorKind::usage, "a simulated stream at " + std::to_string(to_us(p.now)) +
                                          " us cannot go back to " + std::to_string(to_us(end)) +
                                          " us");
    while (p.reached < end) p.sub_frame();
    const auto later = std::ranges::upper_bound(p.ready, end, {}, &Event::t);
    events.insert(events.end(), p.ready.begin(), later);
    p.ready.erase(p.ready.begin(), later);
    p.scene.forget(seconds(p.previous));
    p.exposure.forget(seconds(p.previous));
    p.previous = p.now;
    p.now = end;
}

void SimulatedStream::truth(SensorTime t, double y0, double x0, double span_y, double span_x,
                            Array2<float>& out) const {
    const Parts& p = *parts_;
    const auto per_pixel = [](double span, int n) { return n > 1 ? span / (n - 1) : span; };
    const Affine to_scene = p.to_scene.after(
        {per_pixel(span_x, out.width()), 0, x0, 0, per_pixel(span_y, out.height()), y0});
    const double t_s = seconds(t);
    if (p.target == TargetRule::texture) {
        p.scene.render(t_s, to_scene, Scene::Show::grey, out);
        return;
    }
    p.scene.render(t_s, to_scene, Scene::Show::light_without_flicker, out);
    p.exposure.develop(t_s, p.scene.gain(t_s), out);
}

void SimulatedStream::truth(SensorTime t, Array2<float>& out) const {
    const Array2<float>& sensor = parts_->light;
    truth(t, 0, 0, sensor.height() - 1, sensor.width() - 1, out);
}

}  // namespace eventide
