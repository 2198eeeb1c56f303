// Experiment 9 (reconstruction.md, section 3): the network is given its own last picture, as
// PIE-Net is. Only training knows it; `eventide` runs networks that are given events alone.
#pragma once

#include "src/train/render.h"

namespace eventide {

enum class Feedback {
    none,
    input,    ///< the picture is one more input; the renderer's output stays free
    change,   ///< and the renderer says what to add to the picture
    physical  ///< and the renderer says ln of the factor on the light: mu = (p + k) e^a - k
};

/// The weights this asks for beside those of the model: a column of the first layer, and k.
Parameters with_feedback(Parameters parameters, Feedback feedback);

/// [N][C][H][W] and a picture [N][1][H][W] in one.
torch::Tensor with_picture(const torch::Tensor& grid, const torch::Tensor& picture);

/// Pictures are kept less this grey, so that an empty state shows it.
inline constexpr double kFeedbackGrey = 0.45;

/// What a task's codes start from: the pictures fed back, [N][1][H][W] less the grey. Gradients do
/// not reach them.
struct FedPictures {
    torch::Tensor start, end;  ///< of its event frame; `end` undefined where it is not known
    torch::Tensor f;           ///< [N], place in the event frame, as RenderTask's
};

/// mu and log_sigma of tasks, where those of task i were given pictures[i].
Rendered apply_feedback(Feedback feedback, const Parameters& parameters, const Rendered& out,
                        const std::vector<FedPictures>& pictures, const PatchGrid& points);

/// The picture at the end of the event frame whose code is `current`, from what is known then.
torch::Tensor next_picture(Feedback feedback, const ModelConfig& config,
                           const Parameters& parameters, const torch::Tensor& previous,
                           const torch::Tensor& current, const torch::Tensor& picture);

}  // namespace eventide
