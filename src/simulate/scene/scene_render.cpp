// A scene's image, row by row: background, then each object over it.
#include "src/core/simd4.h"
#include "src/simulate/scene/scene.h"

#include <algorithm>
#include <cmath>

namespace eventide {

namespace {

int round_up_to_4(int n) {
    return (n + 3) & ~3;
}

void apply(const ToneCurve& tone, double gain, std::span<float> values) {
    using namespace lanes;
    const auto offset = float(tone.offset * gain), factor = float(tone.factor * gain);
    for (std::size_t i = 0; i < values.size(); i += 4) {
        float* p = values.data() + i;
        store(p, offset + factor * lanes::exp(load(p) * tone.rate));
    }
}

void blend(std::span<const float> over, std::span<const float> cover, double opacity,
           float* under) {
    using namespace lanes;
    for (std::size_t i = 0; i < over.size(); i += 4) {
        const F4 below = load(under + i);
        store(under + i,
              below + (load(over.data() + i) - below) * (load(cover.data() + i) * float(opacity)));
    }
}

}  // namespace

/// A layer before one camera at one time; all in output pixels.
struct Scene::View {
    const Layer* layer;
    Affine to_image;
    float detail;
    std::optional<ShapeView> shape;
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;  // rows and columns it may cover; x0 is a multiple of 4
    double gain = 1;

    View(const Layer& of, const Affine& to_local, double output_px, int width, int height)
        : layer(&of),
          to_image(of.texture_in_local.after(to_local)),
          detail(of.texture->detail(to_image)) {
        x1 = width;
        y1 = height;
        if (!of.shape) return;
        // An edge is never sharper than a pixel, or it would flicker from step to step.
        const double softness = std::max(1.0, of.softness_px / output_px);
        shape.emplace(*of.shape, to_local, softness);
        const Affine back = to_local.inverse();
        const double reach_x = std::abs(back.xx) + std::abs(back.xy) + softness;
        const double reach_y = std::abs(back.yx) + std::abs(back.yy) + softness;
        const auto clip = [](double v, int n) { return int(std::clamp(v, 0.0, double(n))); };
        x0 = clip(std::floor(back.x0 - reach_x), width) & ~3;
        x1 = clip(std::ceil(back.x0 + reach_x) + 1, width);
        y0 = clip(std::floor(back.y0 - reach_y), height);
        y1 = clip(std::ceil(back.y0 + reach_y) + 1, height);
    }
};

void Scene::render(double t_s, const Affine& to_sensor, Show show, Array2<float>& out) const {
    const int width = out.width(), height = out.height();
    const double scene_s = pauses_.at(t_s);
    const double output_px = std::sqrt(std::abs(to_sensor.determinant()));
    std::vector<View> views;
    for (const Layer& layer : layers_) {
        views.emplace_back(layer, to_local(layer, scene_s).after(to_sensor), output_px, width,
                           height);
        if (show == Show::light) views.back().gain = layer.flicker.at(t_s);
    }
    const std::size_t padded = std::size_t(round_up_to_4(width));
    std::vector<float> row(padded), over(padded), cover(padded);
    for (int y = 0; y < height; ++y) {
        for (const View& view : views) {
            if (y < view.y0 || y >= view.y1 || view.x0 >= view.x1) continue;
            const std::size_t n = std::size_t(round_up_to_4(view.x1 - view.x0));
            const std::span<float> values{view.shape ? over.data() : row.data(), n};
            view.layer->texture->sample(Texture::walk(view.to_image, view.x0, y), view.detail,
                                        values);
            if (show != Show::grey)
                apply(view.layer->tone, view.gain, values);
            else if (view.layer->is_lamp)
                std::ranges::fill(values, 1.F);
            if (!view.shape) continue;
            view.shape->cover(view.x0, y, {cover.data(), n});
            blend(values, {cover.data(), n}, view.layer->opacity, row.data() + view.x0);
        }
        std::copy_n(row.begin(), width, out.row(y).begin());
    }
}

}  // namespace eventide
