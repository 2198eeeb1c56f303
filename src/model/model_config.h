// The shape of a network, as a model file's metadata states it. docs/model.md says what each number
// means.
#pragma once

#include <string>
#include <vector>

namespace eventide {

enum class EncoderKind { gated, thesis };
enum class SigmaRule { log_blend, mixture };
/// At the live edge inside an event window: the newest codes alone, or a cross-fade to them from
/// what was shown at the window's beginning.
enum class LiveEdge { jump, fade };
/// Weight in space of the nearer latent samples: straight in the distance, or without a crease.
enum class Blend { linear, smooth };

struct ModelConfig {
    EncoderKind encoder = EncoderKind::gated;
    int bins = 5;                             ///< B
    std::vector<int> widths{16, 32, 64, 64};  ///< channels per level
    std::vector<int> recurrent{1, 1, 1, 1};   ///< per level: 1 ConvGRU, 0 held features
    bool reset_gate = true;                   ///< of recurrent levels
    int res_blocks = 2;
    int gate_radius = 4;    ///< px
    int gate_spread = 0;    ///< further, at the deepest level, in its pixels
    bool out_layer = true;  ///< a linear layer makes the codes; else they are the last map
    int latent = 16;        ///< D
    int latent_stride = 1;  ///< 1 or 2
    int unfold = 3;  ///< codes in y and x that the renderer reads around a sample: 3 x 3, or 1
    std::vector<int> mlp{64, 64, 64};      ///< hidden widths
    std::vector<int> lookaheads{0, 1, 2};  ///< those the model was trained for
    float log_sigma_min = -6, log_sigma_max = 1;
    float sigma_scale = 1;  ///< calibration: rendered sigma is multiplied by it
    SigmaRule sigma_rule = SigmaRule::log_blend;
    Blend blend = Blend::linear;
    LiveEdge live_edge = LiveEdge::jump;
    bool noise_filter = false;    ///< it was trained on what NoiseFilter leaves
    std::string window = "50ms";  ///< the event windows it was trained for
    std::string card;             ///< data, budget, scores, limits

    int input_channels() const { return 4 * bins + 1; }
    int levels() const { return int(widths.size()); }
    /// Inputs of the renderer's first layer that are codes.
    int unfolded() const { return 3 * unfold * unfold * latent; }
};

}  // namespace eventide
