// What a run has when it begins or goes on: numbers of a checkpoint, and states that fit its
// streams.
#include "apps/train/sound_options.h"
#include "apps/train/trainer.h"

#include <algorithm>

namespace eventide {
namespace {

/// Whether one can be where the other was.
bool alike(const RecurrentState& a, const RecurrentState& b) {
    return a.latent.sizes() == b.latent.sizes() &&
           std::ranges::equal(a.state, b.state, [](const torch::Tensor& x, const torch::Tensor& y) {
               return x.sizes() == y.sizes();
           });
}

}  // namespace

/// The best weights of before are those beside the checkpoint; what another folder has is another
/// run's.
void Trainer::resume() {
    progress_ = load_checkpoint(options_.resume, optimiser_);
    std::error_code none;
    if (!std::filesystem::equivalent(options_.resume, file(kCheckpoint), none))
        progress_.best_score = kNotJudged;
}

/// A run may go on with fewer inputs: what its moments hold of the others must not bring them back.
void Trainer::leave_out_inputs() {
    const torch::NoGradGuard none;
    for (Parameters* numbers :
         {&optimiser_.parameters, &optimiser_.moment1, &optimiser_.moment2, &optimiser_.ema})
        numbers->at("encoder.in.weight") *= input_mask_;
}

/// A run may go on with other streams, another crop or another teacher: states then begin empty.
void Trainer::begin_states() {
    std::vector<RecurrentState>& recurrent_states = progress_.recurrent_states;
    const int crop = options_.data.crop;
    const RecurrentState empty = empty_recurrent_state(options_.model, options_.streams, crop, crop,
                                                       torch::TensorOptions{device_});
    const auto count = std::size_t(options_.threads * options_.groups);
    if (recurrent_states.size() != count || !alike(recurrent_states[0], empty)) {
        recurrent_states.assign(count, empty);
        progress_.teacher_states.clear();
    }
    begin_teacher_states(count);
}

void Trainer::begin_teacher_states(std::size_t places) {
    std::vector<RecurrentState>& states = progress_.teacher_states;
    if (teacher_ == nullptr) return states.clear();
    const auto empty = teacher_->empty_states(options_.streams, options_.data.crop);
    if (states.size() == places * empty.size() && alike(states[0], empty[0])) return;
    states.clear();
    for (std::size_t i = 0; i < places; ++i)
        states.insert(states.end(), empty.begin(), empty.end());
}

}  // namespace eventide
