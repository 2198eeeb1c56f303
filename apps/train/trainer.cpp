#include "apps/train/trainer.h"

#include "apps/train/device.h"
#include "apps/train/network/warm_start.h"
#include "apps/train/sound_options.h"
#include "src/io/output_file.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <thread>

namespace eventide {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What is not named stays as it is, and no gradient is computed for it.
void choose_what_learns(const std::vector<std::string>& prefixes, Parameters& parameters) {
    if (prefixes.empty()) return;
    for (auto& [name, values] : parameters) values.set_requires_grad(false);
    for (const std::string& prefix : prefixes) {
        bool any = false;
        for (auto& [name, values] : parameters) {
            if (prefix.empty() || !name.starts_with(prefix)) continue;
            values.set_requires_grad(true);
            any = true;
        }
        if (!any)
            throw Error(ErrorKind::usage,
                        "--train-only: expected beginnings of names of weights, as " +
                            parameters.begin()->first + ", found '" + prefix + "'");
    }
}

Parameters first_parameters(const TrainOptions& options, torch::Device device, const LogSink& say) {
    Parameters parameters = initial_parameters(options.model, options.data.seed, device);
    if (options.initial.empty()) return parameters;
    std::string left;
    for (const std::string& name : warm_start(options.initial, parameters)) left += " " + name;
    say("initial weights of " + options.initial + ", new:" + (left.empty() ? " none" : left));
    return parameters;
}

}  // namespace

Trainer::Trainer(const TrainOptions& options, std::shared_ptr<const TextureLibrary> textures,
                 std::shared_ptr<const TextureLibrary> validation_textures, const LogSink& say)
    : options_(sound(options)),
      log_(options.out, options.log_every, say),
      device_(device_of(options)),
      type_(arithmetic_type(options)),
      optimiser_(options.optimiser, first_parameters(options, device_, say)),
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
    if (!options.resume.empty()) progress_ = load_checkpoint(options.resume, optimiser_);
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

/// A run may go on with fewer inputs: what its moments hold of the others must not bring them back.
void Trainer::leave_out_inputs() {
    const torch::NoGradGuard none;
    for (Parameters* numbers :
         {&optimiser_.parameters, &optimiser_.moment1, &optimiser_.moment2, &optimiser_.ema})
        numbers->at("encoder.in.weight") *= input_mask_;
}

/// A run may go on with other streams or another crop: its states then begin empty.
void Trainer::begin_states() {
    std::vector<RecurrentState>& recurrent_states = progress_.recurrent_states;
    const int crop = options_.data.crop;
    const RecurrentState empty = empty_recurrent_state(options_.model, options_.streams, crop, crop,
                                                       torch::TensorOptions{device_});
    const auto count = std::size_t(options_.threads * options_.groups);
    if (recurrent_states.size() != count ||
        recurrent_states[0].latent.sizes() != empty.latent.sizes())
        recurrent_states.assign(count, empty);
    begin_teacher_states(count);
}

void Trainer::begin_teacher_states(std::size_t places) {
    std::vector<RecurrentState>& states = progress_.teacher_states;
    if (teacher_ == nullptr) return states.clear();
    const auto empty = teacher_->empty_states(options_.streams, options_.data.crop);
    if (states.size() == places * empty.size() &&
        states[0].latent.sizes() == empty[0].latent.sizes())
        return;
    states.clear();
    for (std::size_t i = 0; i < places; ++i)
        states.insert(states.end(), empty.begin(), empty.end());
}

std::filesystem::path Trainer::file(const char* name) const {
    return std::filesystem::path{options_.out} / name;
}

bool Trainer::finished() const {
    return options_.steps > 0 ? progress_.segment >= options_.steps
                              : progress_.elapsed_minutes >= options_.minutes;
}

double Trainer::learning_rate() const {
    const double done = options_.steps > 0 ? double(progress_.segment) / options_.steps
                                           : progress_.elapsed_minutes / options_.minutes;
    const double rise = std::min(1.0, double(progress_.segment + 1) / (options_.warm_up + 1));
    const double falling =
        std::clamp((done - options_.constant_share) / (1 - options_.constant_share), 0.0, 1.0);
    const double cosine = 0.5 * (1 + std::cos(std::numbers::pi * falling));
    return options_.learning_rate * rise *
           (options_.final_rate + (1 - options_.final_rate) * cosine);
}

/// Waits for the simulator; one batch per share.
std::vector<TrainingBatch> Trainer::load() {
    const std::vector<StreamSegment> segments = feed_->next();
    const auto streams = std::size_t(options_.streams);
    std::vector<TrainingBatch> batches;
    for (std::size_t i = 0; i < segments.size(); i += streams)
        batches.push_back(to_batch(std::span{segments}.subspan(i, streams), device_));
    return batches;
}

/// A GPU computes a step while the processor copies what the next one reads.
std::vector<TrainingBatch> Trainer::next_batches() {
    std::vector<TrainingBatch> batches = upcoming_.valid() ? upcoming_.get() : load();
    if (device_.is_cuda()) upcoming_ = std::async(std::launch::async, [this] { return load(); });
    return batches;
}

/// The truth, and so much of the teacher's frames as its share is.
torch::Tensor Trainer::taught(const torch::Tensor& truth, const TrainingBatch& batch,
                              const SegmentPlan& plan, int place) {
    const auto views = std::size_t(options_.teacher_views);
    const auto states =
        std::span{progress_.teacher_states}.subspan(std::size_t(place) * views, views);
    return truth.lerp(teacher_->frames(plan, batch, options_.data.patch, states),
                      options_.teacher_share);
}

/// `place` in recurrent_states: of the group whose turn it is and of the thread.
Trainer::Share Trainer::run_share(const TrainingBatch& batch, const SegmentPlan& plan, int place) {
    at::set_num_threads(1);  // libgomp keeps the number per thread
    RecurrentState& recurrent = progress_.recurrent_states[std::size_t(place)];
    recurrent = begin_segment(recurrent, batch.fresh);
    const Parameters narrow =
        type_ == torch::kFloat ? optimiser_.parameters : cast(optimiser_.parameters, type_);
    Images images =
        run_segment(options_.model, narrow, plan, batch, options_.data.patch, recurrent);
    if (teacher_ != nullptr) images.taught = taught(images.truth, batch, plan, place);
    Share share;
    const bool looks = options_.lpips_on_pixels || !plan.on_pixels;
    share.terms =
        loss(images, options_.loss, looks ? perceptual_.get() : nullptr, options_.lpips_frames);
    std::vector<torch::Tensor> leaves;
    std::vector<std::string> names;
    for (const auto& [name, values] : optimiser_.parameters) {
        if (!values.requires_grad()) continue;
        leaves.push_back(values);
        names.push_back(name);
    }
    const auto gradients = torch::autograd::grad({share.terms.total}, leaves, {}, {}, false,
                                                 /*allow_unused=*/true);
    for (std::size_t i = 0; i < names.size(); ++i)
        share.gradients[names[i]] =
            gradients[i].defined() ? gradients[i] : torch::zeros_like(leaves[i]);
    recurrent = {detach(recurrent.state), recurrent.latent.detach()};
    return share;
}

void Trainer::step() {
    const auto start = Clock::now();
    const double cpu_start = cpu_seconds();
    const SegmentPlan plan = segment_plan(options_.data, progress_.segment);
    const std::vector<TrainingBatch> batches = next_batches();
    std::vector<Share> shares(std::size_t(options_.threads));
    const int first_place = int(progress_.segment % options_.groups) * options_.threads;
    {
        std::vector<std::jthread> threads;
        const auto work = [&](std::size_t i) {
            shares[i] = run_share(batches[i], plan, first_place + int(i));
        };
        for (std::size_t i = 1; i < shares.size(); ++i) threads.emplace_back(work, i);
        work(0);
    }
    Parameters& gradients = shares[0].gradients;
    LossTerms& terms = shares[0].terms;
    for (auto& [name, g] : gradients) {
        for (std::size_t i = 1; i < shares.size(); ++i) g = g + shares[i].gradients.at(name);
        g = g / double(shares.size());
    }
    for (std::size_t k = 0; k < terms.means.size(); ++k) {
        for (std::size_t i = 1; i < shares.size(); ++i) terms.means[k] += shares[i].terms.means[k];
        terms.means[k] /= double(shares.size());
    }
    if (const auto of_inputs = gradients.find("encoder.in.weight"); of_inputs != gradients.end())
        of_inputs->second = of_inputs->second * input_mask_;  // what starts at 0 stays there
    const double rate = learning_rate(), norm = optimiser_.step(gradients, rate);
    if (!std::isfinite(norm)) {  // a state that has run away must not spoil the next segments
        ++skipped_;
        for (RecurrentState& recurrent :
             std::span{progress_.recurrent_states}.subspan(std::size_t(first_place), shares.size()))
            recurrent =
                begin_segment(recurrent, std::vector<bool>(std::size_t(options_.streams), true));
    }
    ++progress_.segment;
    const double seconds = seconds_since(start);
    progress_.elapsed_minutes +=
        (options_.clock == "cpu" ? cpu_seconds() - cpu_start : seconds) / 60;
    log_.step(mark(), terms, {rate, norm, seconds, skipped_});
}

void Trainer::validate() {
    if (validation_ == nullptr) return;
    const Parameters weights = cast(optimiser_.ema, type_);
    const auto scores =
        validation_->judge(options_.model, weights, 0, options_.loss, perceptual_.get());
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
    // A resumed run may be judged by other scenes than before: its best begins with what it
    // resumes.
    if (!options_.resume.empty() && !finished()) {
        progress_.best_score = std::numeric_limits<double>::infinity();
        validate();
    }
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
    if (std::filesystem::exists(file(kBest))) model.weights = load_model(file(kBest)).weights;
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
