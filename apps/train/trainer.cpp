#include "apps/train/trainer.h"

#include "apps/train/device.h"
#include "apps/train/first_weights.h"
#include "apps/train/sound_options.h"
#include "src/io/output_file.h"

#include <chrono>
#include <sstream>

namespace eventide {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

Trainer::Trainer(const TrainOptions& options, std::shared_ptr<const TextureLibrary> textures,
                 std::shared_ptr<const TextureLibrary> validation_textures, const LogSink& say)
    : options_(sound(options)),
      log_(options.out, options.log_every, say),
      device_(device_of(options)),
      type_(arithmetic_type(options)),
      optimiser_(options.optimiser, first_weights(options, device_, say)),
      input_mask_(input_mask(options.model, options.inputs).to(device_)) {
    // One thread per share: libgomp's barriers cost more than they give where cores are shared.
    at::set_num_threads(1);
    at::globalContext().setBenchmarkCuDNN(true);
    options_.data.bins = options.model.bins;
    options_.data.noise_filter = options.model.noise_filter;
    create_folder(options.out);
    if (!options.lpips.empty())
        perceptual_ = std::make_unique<Perceptual>(options.lpips, device_, type_);
    if (!options.teacher.empty())
        teacher_ =
            std::make_unique<const Teacher>(options.teacher, options.teacher_views, device_, type_);
    if (teacher_ != nullptr && teacher_->bins() != options_.data.bins)
        options_.data.teacher_bins = teacher_->bins();
    if (!options.resume.empty()) resume();
    leave_out_inputs();
    choose_what_learns(options.train_only, optimiser_.parameters);
    progress_.options = OptionTable{options_}.record();
    begin_states();
    if (options.validation_scenes > 0)
        validation_ = std::make_unique<Validation>(
            ValidationSettings{options.validation_scenes, options.validation_windows,
                               options.validation_crop, 4242},
            options_.data, std::move(validation_textures), device_);
    feed_ = std::make_unique<DataLoader>(
        options_.data, std::move(textures), options.threads * options.streams, options.groups,
        progress_.segment, device_.is_cuda() ? SimulatorPriority::behind : SimulatorPriority::same);
}

std::filesystem::path Trainer::file(const char* name) const {
    return std::filesystem::path{options_.out} / name;
}

bool Trainer::finished() const {
    return options_.steps > 0 ? progress_.segment >= options_.steps
                              : progress_.elapsed_minutes >= options_.minutes;
}

Validation::Scores Trainer::scores_of(const Parameters& weights) const {
    return validation_->judge(options_.model, weights, 0, options_.loss, perceptual_.get());
}

/// A run may go on with other scenes to be judged by: the best of before are judged by them, too.
void Trainer::judge_again() {
    progress_.best_score =
        validation_ != nullptr && has_best()
            ? scores_of(cast(to_parameters(load_model(file(kBest)).weights, device_), type_)).score
            : kNotJudged;
    validate();
}

bool Trainer::has_best() const {
    return progress_.best_score < kNotJudged && std::filesystem::exists(file(kBest));
}

void Trainer::validate() {
    if (validation_ == nullptr) return;
    const Parameters weights = cast(optimiser_.ema, type_);
    const auto scores = scores_of(weights);
    log_.validation(mark(), scores);
    validation_->write_sheet(file("sheet.pgm"), options_.model, weights, 0);
    if (scores.score < progress_.best_score) {
        progress_.best_score = scores.score;
        save_model(file(kBest), {options_.model, to_tensors(optimiser_.ema)});
    }
}

void Trainer::checkpoint() {
    save_checkpoint(file(kCheckpoint), progress_, optimiser_);
}

void Trainer::run(const std::atomic<bool>& stop) {
    const auto due = [](double minutes) { return std::chrono::duration<double>(minutes * 60); };
    auto saved = Clock::now(), judged = saved;
    if (!options_.resume.empty() && !finished()) judge_again();
    while (!finished() && !stop) {
        step();
        if (Clock::now() - judged >= due(options_.validate_minutes)) {
            validate();
            judged = Clock::now();
        }
        if (Clock::now() - saved >= due(options_.checkpoint_minutes)) {
            checkpoint();
            saved = Clock::now();
        }
    }
    if (finished()) validate();
    checkpoint();
}

void Trainer::keep(const std::filesystem::path& path) const {
    Checkpoint without_states = progress_;
    without_states.recurrent_states.clear();
    without_states.teacher_states.clear();
    save_checkpoint(path, without_states, optimiser_);
}

Model Trainer::finished_model() const {
    Model model{options_.model, to_tensors(optimiser_.ema)};
    if (has_best()) model.weights = load_model(file(kBest)).weights;
    std::ostringstream card;
    card << options_.card << (options_.card.empty() ? "" : " ")
         << "Trained by eventide-train: " << progress_.segment << " steps, "
         << std::lround(progress_.elapsed_minutes) << " minutes. ";
    if (validation_ != nullptr) {
        const Parameters weights = to_parameters(model.weights, device_);
        model.config.sigma_scale = float(validation_->sigma_scale(options_.model, weights, 0));
        for (const int lookahead : {0, 2}) {
            const auto scores = validation_->judge(options_.model, weights, lookahead,
                                                   options_.loss, perceptual_.get());
            card << "Held-out simulated scenes, lookahead " << lookahead
                 << ", sigma not yet scaled:";
            for (std::size_t k = 0; k < scores.means.size(); ++k)
                card << " " << kLossNames[k] << " " << scores.means[k];
            card << ". ";
        }
    }
    TrainOptions options = options_;
    card << "Options: " << OptionTable{options}.settings();
    model.config.card = card.str();
    return model;
}

}  // namespace eventide
