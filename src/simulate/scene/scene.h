// A scene: a textured background, objects before it, and the light on both.
#pragma once

#include "src/core/array.h"
#include "src/simulate/scene/motion.h"
#include "src/simulate/scene/scene_settings.h"
#include "src/simulate/scene/shape.h"
#include "src/simulate/scene/textures.h"

#include <memory>
#include <optional>
#include <vector>

namespace eventide {

/// Turns a grey value x into light: offset + factor exp(rate x), in lux.
struct ToneCurve {
    float offset = 0, factor = 1, rate = 1;
};

/// Light that pulses with the mains: 1 + depth cos(2 pi frequency t + phase).
struct Flicker {
    double depth = 0, frequency_hz = 100, phase = 0;
    double at(double t_s) const;
};

/// Times are seconds since the scene's beginning, at least 0, and lie between the latest forget()
/// and prepare(). Places are sensor pixels.
class Scene {
public:
    Scene(const SceneSettings& settings, std::shared_ptr<const TextureLibrary> textures, int width,
          int height, Random random);

    void prepare(double until_s);
    void forget(double before_s);

    /// How long from t until something has moved by settings.step_px; needs prepare(t + step_s
    /// .high). Depends on t and the scene only.
    double step(double t_s) const;

    enum class Show { light, light_without_flicker, grey };

    /// Light (lux, without gain()) or grey values at the places to_sensor(output pixel).
    void render(double t_s, const Affine& to_sensor, Show show, Array2<float>& out) const;

    double gain(double t_s) const;  ///< the light's changes as a factor, flicker left out
    double flicker(double t_s) const { return flicker_.at(t_s); }
    double white_lux() const { return white_lux_; }

private:
    struct Layer {
        const Texture* texture = nullptr;
        std::unique_ptr<Motion> motion;          // none: it is fixed to the background ...
        Affine pin;                              // ... whose plane -> its own [-1, 1]^2
        std::optional<PauseClock> pauses;        // on top of the scene's
        std::optional<Shape> shape;              // none: the background
        double half_width = 1, half_height = 1;  // px, of an object
        double softness_px = 0, opacity = 1;
        Affine texture_in_local;  // [-1, 1]^2 -> the texture's [0, 1]^2
        ToneCurve tone;
        bool is_lamp = false;  // white all over, whatever its texture
        Flicker flicker;
    };
    struct View;

    void draw_light(const SceneSettings& settings);
    ToneCurve tone_curve(double gain) const;
    void add_background(const SceneSettings& settings);
    void add_object(const SceneSettings& settings, bool pinned);
    void add_lamp(const SceneSettings& settings);
    void set_moving(Layer& layer, const SceneSettings& settings, const Home& home);
    void draw_shape(Layer& layer, const SceneSettings& settings);
    double layer_time(const Layer& layer, double scene_s) const;
    Affine to_local(const Layer& layer, double scene_s) const;
    double movement(const Layer& layer, double from_s, double to_s) const;

    std::shared_ptr<const TextureLibrary> textures_;
    int width_, height_;
    Range step_s_;
    double step_px_;
    bool thesis_;
    Random random_;
    double speed_ = 0, white_lux_ = 1, dynamic_range_ = 1, tone_ = 1;
    Range grey_{0, 1};
    PauseClock pauses_;
    std::optional<LightChanges> light_;
    Flicker flicker_;
    std::vector<Layer> layers_;  // from back to front
};

}  // namespace eventide
