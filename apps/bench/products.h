// How many products of numbers a network's stages are made of: what is useful, however it is
// computed. Borders, rims of tiles, gates, exponentials and offsets are not counted.
#pragma once

#include "src/model/model_config.h"
#include "src/model/render/sampling.h"

#include <vector>

namespace eventide::bench {

/// A 3x3 convolution over a map of height x width.
struct Layer {
    int height, width, in, out, stride;
    double products() const {
        const int rows = (height + stride - 1) / stride, columns = (width + stride - 1) / stride;
        return 9.0 * in * out * rows * columns;
    }
};

/// Every convolution of an encoder for a sensor of height x width, in the order of docs/model.md.
std::vector<Layer> encoder_layers(const ModelConfig& config, int height, int width);
double products_of(const std::vector<Layer>& layers);

/// One event window, everything moving.
double encode_products(const ModelConfig& config, int height, int width);

/// A frame inside an event window, at a lookahead that every window before had too.
struct RenderProducts {
    double first = 0;  ///< the first layer at every latent sample, once per event window
    double end = 0;    ///< what the window before shows at its end, where the live edge fades: once
    double frame = 0;  ///< the layers behind the first, at every sample around every pixel
};
RenderProducts render_products(const ModelConfig& config, const FrameGeometry& geometry,
                               int lookahead);

}  // namespace eventide::bench
