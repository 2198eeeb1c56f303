#include "apps/train/contrast.h"

#include "src/core/error.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace eventide {

void stretch_contrast(Model& model, double gain, double around) {
    if (!std::isfinite(gain) || gain <= 0 || !(around >= 0 && around <= 1))
        throw Error(ErrorKind::usage,
                    "--contrast: expected a gain above 0 and an intensity in [0, 1], found " +
                        std::to_string(gain) + " and " + std::to_string(around));
    const std::string last = "renderer.mlp." + std::to_string(model.config.mlp.size());
    std::vector<float>& weights = model.weights.at(last + ".weight").values;
    // Rows are (mu, s); the first alone is intensity.
    for (std::size_t i = 0; i < weights.size() / 2; ++i) weights[i] = float(gain * weights[i]);
    float& offset = model.weights.at(last + ".bias").values.front();
    offset = float(around + gain * (offset - around));
}

}  // namespace eventide
