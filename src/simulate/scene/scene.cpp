// Draws a scene from its settings' ranges, and how its layers move.
#include "src/simulate/scene/scene.h"

#include "src/core/error.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace eventide {

double Flicker::at(double t_s) const {
    if (depth <= 0) return 1;
    return 1 + depth * std::cos(2 * std::numbers::pi * frequency_hz * t_s + phase);
}

namespace {

Flicker draw_flicker(Range depth, Random& random) {
    constexpr std::array<double, 4> kMainsHz{50, 60, 100, 120};
    return {.depth = random.uniform(depth),
            .frequency_hz = kMainsHz[std::size_t(random.integer(0, 3))],
            .phase = random.uniform({0, 2 * std::numbers::pi})};
}

/// Sensor pixels -> [-1, 1]^2 with the corner pixels' centres at the corners.
Affine normalised(int width, int height) {
    return {2.0 / std::max(1, width - 1), 0, -1, 0, 2.0 / std::max(1, height - 1), -1};
}

}  // namespace

Scene::Scene(const SceneSettings& settings, std::shared_ptr<const TextureLibrary> textures,
             int width, int height, Random random)
    : textures_(std::move(textures)),
      width_(width),
      height_(height),
      step_s_(settings.step_s),
      step_px_(settings.step_px),
      thesis_(settings.background == BackgroundMotion::thesis),
      random_(random),
      pauses_(settings.pause_start, settings.pause_stay, settings.pause_step_s, random_.fork()) {
    if (!textures_ || textures_->empty())
        throw Error(ErrorKind::usage, "a simulated scene needs at least one texture, but has none");
    if (width < 2 || height < 2)
        throw Error(ErrorKind::usage, "a simulated sensor needs at least 2 x 2 pixels, not " +
                                          std::to_string(width) + " x " + std::to_string(height));
    const WanderSettings& wander = settings.wander;
    speed_ = random_.log_uniform(random_.chance(wander.usual) ? wander.usual_speed : wander.speed);
    draw_light(settings);
    add_background(settings);
    const double share = std::pow(random_.uniform(), settings.objects_skew);
    const int more = settings.objects_max - settings.objects_min + 1;
    const int objects = std::min(settings.objects_max, settings.objects_min + int(share * more));
    if (settings.pinned_max > 0 && !thesis_)
        for (int i = random_.integer(0, settings.pinned_max); i > 0; --i)
            add_object(settings, true);
    for (int i = 0; i < objects; ++i) add_object(settings, false);
    if (settings.lamp > 0) add_lamp(settings);
}

void Scene::draw_light(const SceneSettings& settings) {
    white_lux_ = random_.log_uniform(settings.white_lux);
    dynamic_range_ = random_.log_uniform(settings.dynamic_range);
    if (settings.black_lux.high > 0) {
        white_lux_ = random_.uniform(settings.white_lux);
        dynamic_range_ = white_lux_ / random_.uniform(settings.black_lux);
    }
    tone_ = random_.uniform(settings.tone);
    if (random_.chance(settings.faint_probability)) {
        const double contrast = random_.uniform(settings.faint_contrast);
        grey_.low = random_.uniform({0, 1 - contrast});
        grey_.high = grey_.low + contrast;
    }
    if (random_.chance(settings.light_change_probability)) {
        const double depth = random_.uniform(settings.light_change);
        const double step_s = random_.log_uniform(settings.light_change_s);
        light_.emplace(depth, step_s, random_.fork());
    }
    if (random_.chance(settings.flicker_probability))
        flicker_ = draw_flicker(settings.flicker_depth, random_);
}

/// L = L_min + norm01(exp(k x)) (L_max - L_min), x squeezed into the scene's grey values.
ToneCurve Scene::tone_curve(double gain) const {
    const double k =
        std::max(tone_, .02);  // below, rounding would show; .02 is straight within 1 %
    const double white = white_lux_ * gain, black = white / dynamic_range_;
    const double per_exp = (white - black) / (std::exp(k) - 1);
    return {.offset = float(black - per_exp),
            .factor = float(per_exp * std::exp(k * grey_.low)),
            .rate = float(k * (grey_.high - grey_.low))};
}

void Scene::add_background(const SceneSettings& settings) {
    Layer layer;
    layer.texture = &(*textures_)[std::size_t(random_.integer(0, int(textures_->size()) - 1))];
    layer.tone = tone_curve(1);
    if (thesis_) {
        layer.motion = thesis_motion(settings.thesis, random_.fork());
        layer.texture_in_local = {.5, 0, .5, 0, .5, .5};
    } else {
        const double speed = random_.chance(settings.still_background) ? 0 : speed_;
        const double radius = std::hypot(width_, height_) / 2;
        layer.motion = wander_motion(settings.wander, speed, radius, {}, {}, random_.fork());
        const double seen = std::min(width_, height_) / random_.log_uniform(settings.view_share);
        const double aspect = layer.texture->aspect();
        const double height_px = std::min(seen / std::min(1.0, aspect),
                                          settings.magnified_most * layer.texture->height());
        const double width_px = height_px * aspect;
        layer.texture_in_local = {1 / width_px,     0, random_.uniform(), 0, 1 / height_px,
                                  random_.uniform()};
    }
    layers_.push_back(std::move(layer));
}

/// Where it starts and how it goes on from there.
void Scene::set_moving(Layer& layer, const SceneSettings& settings, const Home& home) {
    const double speed = std::clamp(speed_ * random_.log_uniform(settings.object_speed),
                                    settings.wander.speed.low, settings.wander.speed.high);
    const Point start{random_.uniform({0, double(width_)}), random_.uniform({0, double(height_)})};
    layer.motion =
        wander_motion(settings.wander, speed, layer.half_width, start, home, random_.fork());
    if (random_.chance(settings.object_pauses))
        layer.pauses.emplace(settings.pause_start, settings.pause_stay, settings.pause_step_s,
                             random_.fork());
}

void Scene::draw_shape(Layer& layer, const SceneSettings& settings) {
    if (!random_.chance(settings.polygon_probability))
        layer.shape = random_.chance(settings.ring_probability)
                          ? Shape::ring(random_.uniform({.3, .8}))
                          : Shape::disc();
    else if (const int corners = random_.integer(3, 8); corners == 4)
        layer.shape = Shape::rectangle();
    else
        layer.shape = Shape::polygon(corners, random_);
    layer.softness_px = random_.uniform(settings.edge_softness_px);
}

void Scene::add_object(const SceneSettings& settings, bool pinned) {
    Layer layer;
    layer.texture = &(*textures_)[std::size_t(random_.integer(0, int(textures_->size()) - 1))];
    layer.tone = tone_curve(random_.log_uniform(settings.object_gain));
    const double length = random_.log_uniform(settings.object_size) * std::min(width_, height_);
    layer.half_width = length / 2;
    layer.half_height = length / 2 * random_.uniform(settings.object_aspect);
    if (pinned) {
        const auto place = [&](int size) { return random_.uniform({-.75 * size, .75 * size}); };
        layer.pin = Affine::scale(1 / layer.half_width, 1 / layer.half_height)
                        .after(Affine::rotation(random_.uniform({0, 2 * std::numbers::pi})))
                        .after(Affine::translation(place(width_), place(height_)));
    } else {
        const double reach = settings.object_reach * length;
        set_moving(layer, settings, {-reach, -reach, width_ + reach, height_ + reach});
    }
    draw_shape(layer, settings);
    layer.opacity = random_.uniform(settings.opacity);
    if (random_.chance(settings.object_flicker_probability))
        layer.flicker = draw_flicker(settings.flicker_depth, random_);
    // A cut-out of the texture, in the texture's own proportions.
    double cut = random_.log_uniform({.15, 1}) / 2;
    constexpr double kOneGrey = 1e-4;
    if (settings.object_flat > 0 && random_.chance(settings.object_flat)) cut = kOneGrey;
    layer.texture_in_local = {cut,
                              0,
                              random_.uniform(),
                              0,
                              cut * layer.texture->aspect() * layer.half_height / layer.half_width,
                              random_.uniform()};
    layers_.push_back(std::move(layer));
}

/// An eighth of the shorter side across, and as bright all over. It turns back at the edge of the
/// view, and does not go so far at a time that it would be out of it for long.
void Scene::add_lamp(const SceneSettings& settings) {
    constexpr double kLampLeg = .3;  // of its home's diagonal
    Layer layer;
    layer.texture = &(*textures_)[0];
    layer.tone = {.offset = float(white_lux_ * settings.lamp), .factor = 0, .rate = 0};
    layer.is_lamp = true;
    const double length = std::min(width_, height_) / 8.;
    layer.half_width = layer.half_height = length / 2;
    const double margin = length / 2;
    set_moving(layer, settings, {margin, margin, width_ - margin, height_ - margin, kLampLeg});
    layer.shape = Shape::disc();
    layer.softness_px = 1;
    layers_.push_back(std::move(layer));
}

void Scene::prepare(double until_s) {
    pauses_.prepare(until_s);
    if (light_) light_->prepare(until_s);
    for (Layer& layer : layers_) {
        if (layer.pauses) layer.pauses->prepare(until_s);
        if (layer.motion) layer.motion->prepare(until_s);  // pauses only make its own time shorter
    }
}

void Scene::forget(double before_s) {
    const double scene_s = pauses_.at(before_s);
    for (Layer& layer : layers_) {
        if (layer.motion) layer.motion->forget(layer_time(layer, scene_s));
        if (layer.pauses) layer.pauses->forget(scene_s);
    }
    if (light_) light_->forget(before_s);
    pauses_.forget(before_s);
}

double Scene::layer_time(const Layer& layer, double scene_s) const {
    return layer.pauses ? layer.pauses->at(scene_s) : scene_s;
}

/// Sensor pixels -> the layer's own plane: an object's [-1, 1]^2, the background's pixels, or the
/// thesis' image coordinates.
Affine Scene::to_local(const Layer& layer, double scene_s) const {
    if (!layer.motion) return layer.pin.after(to_local(layers_.front(), scene_s));
    const Pose pose = layer.motion->at(layer_time(layer, scene_s));
    if (layer.shape) {
        const Affine scale =
            Affine::scale(pose.scale_x * layer.half_width, pose.scale_y * layer.half_height);
        return Affine::translation(pose.x, pose.y)
            .after(Affine::rotation(pose.angle))
            .after(scale)
            .inverse();
    }
    if (thesis_) return thesis_transform(pose).after(normalised(width_, height_));
    // Spin and zoom are about the view's centre, wherever it has wandered to.
    return Affine::translation(pose.x, pose.y)
        .after(Affine::scale(1 / pose.scale_x, 1 / pose.scale_y))
        .after(Affine::rotation(-pose.angle))
        .after(Affine::translation(-(width_ - 1) / 2.0, -(height_ - 1) / 2.0));
}

/// Largest way (px) that a corner of the layer goes: a background's at the sensor's corners.
double Scene::movement(const Layer& layer, double from_s, double to_s) const {
    if (!layer.motion) return 0;  // no more than the background
    const double scene_from = pauses_.at(from_s), scene_to = pauses_.at(to_s);
    if (layer_time(layer, scene_from) == layer_time(layer, scene_to)) return 0;
    const Affine before = to_local(layer, scene_from);
    const Affine back = to_local(layer, scene_to).inverse();
    const Affine back_before = before.inverse();
    double largest = 0;
    for (const double y : {-1.0, 1.0})
        for (const double x : {-1.0, 1.0}) {
            const Point local =
                layer.shape ? Point{x, y}
                            : before({(x + 1) / 2 * (width_ - 1), (y + 1) / 2 * (height_ - 1)});
            const Point a = back_before(local), b = back(local);
            largest = std::max(largest, std::hypot(b.x - a.x, b.y - a.y));
        }
    return largest;
}

double Scene::step(double t_s) const {
    constexpr double kPerPulse = 16;
    double step = step_s_.high;
    if (flicker_.depth > 0) step = std::min(step, 1 / (kPerPulse * flicker_.frequency_hz));
    if (light_) {
        constexpr double kLogPerStep = .1;  // or the bends between changes would be cut off
        step = std::min(step, kLogPerStep / light_->steepest());
    }
    for (const Layer& layer : layers_) {
        if (layer.flicker.depth > 0)
            step = std::min(step, 1 / (kPerPulse * layer.flicker.frequency_hz));
        while (step > step_s_.low) {
            const double moved = movement(layer, t_s, t_s + step);
            if (moved <= step_px_) break;
            step = std::max(step_s_.low, step * std::clamp(.95 * step_px_ / moved, .1, .95));
        }
    }
    return std::max(step, step_s_.low);
}

double Scene::gain(double t_s) const {
    return light_ ? std::exp(light_->log_gain(t_s)) : 1;
}

}  // namespace eventide
