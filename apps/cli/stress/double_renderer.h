// The renderer in double precision, as docs/model.md states it: what the engine's frames are held
// against.
#pragma once

#include "src/model/model_file.h"
#include "src/model/render/plain_renderer.h"
#include "src/model/render/sampling.h"

#include <array>
#include <vector>

namespace eventide::stress {

/// Query by query: the codes around each sample go through the whole MLP, so a part of a frame
/// costs the same on any sensor. The engines, the plain one too, work out once for all queries what
/// layer 1 makes of codes; nothing of theirs is used here but where samples lie.
class DoubleRenderer {
public:
    using Codes = plain::Codes<double>;

    explicit DoubleRenderer(const Model& model);

    plain::RenderedFrame<double> render(const Codes& codes, double fraction,
                                        const FrameGeometry& geometry, SigmaRule rule) const;

private:
    struct Layer {
        std::vector<double> weight, bias;  // [out][in], [out]
    };
    /// Latent sample (k + dk, j, i), and where the query lies from it: in t, x and y.
    struct Sample {
        int dk, j, i;
        std::array<double, 3> offset;
    };
    struct Member {
        double mu, log_sigma;
    };
    struct Pixel {
        double intensity, sigma;
    };
    Pixel blend(const Codes& codes, const AxisSamples& t, const AxisSamples& y,
                const AxisSamples& x, SigmaRule rule) const;
    std::vector<double> input(const Codes& codes, const Sample& sample) const;
    Member mlp(std::vector<double> numbers) const;

    ModelConfig config_;
    std::vector<Layer> layers_;
};

}  // namespace eventide::stress
