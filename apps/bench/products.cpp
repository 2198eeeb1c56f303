// See products.h; docs/model.md has the formulas.
#include "apps/bench/products.h"

#include <cstddef>

namespace eventide::bench {
namespace {

int half(int n) {
    return (n + 1) / 2;
}

std::vector<Layer> thesis_layers(const ModelConfig& config, int h, int w) {
    const int n = config.widths[0];
    return {{h, w, config.input_channels(), n, 1},
            {h, w, 2 * n, 2 * n, 1},  // gru.0
            {h, w, 2 * n, n, 1},
            {h, w, n, n, 1},  // res
            {h, w, n, n, 1},
            {h, w, n, n, 2},                      // down
            {half(h), half(w), 2 * n, 2 * n, 1},  // gru.1
            {half(h), half(w), 2 * n, n, 1},
            {h, w, 3 * n, n, 1},  // head
            {h, w, n, n, 1},
            {h, w, n, config.latent, 1}};
}

std::vector<Layer> gated_layers(const ModelConfig& config, int height, int width) {
    std::vector<Layer> layers, up;
    const std::vector<int>& c = config.widths;
    int h = height, w = width;
    for (std::size_t l = 0; l < c.size(); ++l) {
        if (l == 0) {
            layers.push_back({h, w, config.input_channels(), c[0], 1});
        } else {
            layers.push_back({h, w, c[l - 1], c[l], 2});
            h = half(h);
            w = half(w);
        }
        if (config.recurrent[l] != 0) {
            layers.push_back({h, w, 2 * c[l], (config.reset_gate ? 2 : 1) * c[l], 1});
            layers.push_back({h, w, 2 * c[l], c[l], 1});
        }
        const bool is_joined = l + 1 < c.size() && int(l) >= config.latent_stride - 1;
        if (is_joined) up.push_back({h, w, c[l] + c[l + 1], c[l], 1});
    }
    for (int i = 0; i < 2 * config.res_blocks; ++i) layers.push_back({h, w, c.back(), c.back(), 1});
    layers.insert(layers.end(), up.rbegin(), up.rend());
    if (!config.out_layer) return layers;
    layers.push_back({latent_samples(height, config.latent_stride),
                      latent_samples(width, config.latent_stride),
                      c[std::size_t(config.latent_stride - 1)], config.latent, 1});
    return layers;
}

/// How many samples with a weight the outputs of one axis have together.
double samples_of(int at, int count, int out_size, int sensor_size, const ModelConfig& config) {
    double samples = 0;
    for (int i = at; i < at + count; ++i) {
        const AxisSamples axis =
            sample_axis(i, out_size, sensor_size, config.latent_stride, config.blend);
        samples += double(axis.weight[0] != 0) + double(axis.weight[1] != 0);
    }
    return samples;
}

}  // namespace

std::vector<Layer> encoder_layers(const ModelConfig& config, int height, int width) {
    return config.encoder == EncoderKind::thesis ? thesis_layers(config, height, width)
                                                 : gated_layers(config, height, width);
}

double products_of(const std::vector<Layer>& layers) {
    double sum = 0;
    for (const Layer& layer : layers) sum += layer.products();
    return sum;
}

double encode_products(const ModelConfig& config, int height, int width) {
    return products_of(encoder_layers(config, height, width));
}

RenderProducts render_products(const ModelConfig& config, const FrameGeometry& geometry,
                               int lookahead) {
    const double codes = double(config.unfold) * config.unfold * config.latent * config.mlp[0] *
                         latent_samples(geometry.sensor_height, config.latent_stride) *
                         latent_samples(geometry.sensor_width, config.latent_stride);
    // Lookahead 0: that of k over two codes, and that of k - 1, which is there. 1: k over three
    // codes and k + 1 over two. 2: k + 1 over three; k is there.
    const int maps_of_codes[] = {2, 5, 3};
    const double times = lookahead > 0 ? 2 : 1;
    const bool fades = lookahead == 0 && config.live_edge == LiveEdge::fade;
    double hidden = 2.0 * config.mlp.back();
    for (std::size_t i = 1; i < config.mlp.size(); ++i)
        hidden += double(config.mlp[i - 1]) * config.mlp[i];
    const double pixels =
        samples_of(geometry.y, geometry.part_height, geometry.height, geometry.sensor_height,
                   config) *
        samples_of(geometry.x, geometry.part_width, geometry.width, geometry.sensor_width, config);
    return {maps_of_codes[lookahead] * codes, fades ? pixels * hidden : 0, times * pixels * hidden};
}

}  // namespace eventide::bench
