// What the options of eventide-train are. Checkpoints record them in this order.
#include "apps/train/options.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <sstream>
#include <type_traits>

namespace eventide {
namespace {

/// What `part` of the text that was given says.
template <typename T>
T item(const std::string& part, const std::string& given) {
    if constexpr (std::is_same_v<T, std::string>) {
        return part;
    } else if constexpr (std::is_same_v<T, bool>) {
        if (part != "0" && part != "1") throw_usage("a number", given);
        return part == "1";
    } else {
        const auto found = number_in<T>(part);
        if (!found) throw_usage("a number", given);
        return *found;
    }
}
template <typename T>
std::string shown(const T& value) {
    if constexpr (std::is_same_v<T, std::string>)
        return value;
    else if constexpr (std::is_same_v<T, double>)
        return show_number(value);
    else
        return std::to_string(value);
}

template <typename T>
Setting setting_of(const std::string& key, T& value, const std::string& help) {
    return parsed_setting<T>(
        key, value, "", help, [](const std::string& text) { return item<T>(text, text); },
        shown<T>);
}
template <typename T>
Setting setting_of(const std::string& key, std::vector<T>& value, const std::string& help) {
    return parsed_setting<std::vector<T>>(
        key, value, "", help,
        [](const std::string& text) {
            std::vector<T> items;
            std::istringstream parts{text};
            for (std::string part; std::getline(parts, part, ',');)
                items.push_back(item<T>(part, text));
            return items;
        },
        [](const std::vector<T>& items) {
            std::string text;
            for (const T& one : items) text += (text.empty() ? "" : ",") + shown(one);
            return text;
        });
}
Setting setting_of(const std::string& key, Range& value, const std::string& help) {
    return parsed_setting<Range>(
        key, value, "", help,
        [](const std::string& text) {
            const auto comma = text.find(',');
            if (comma == text.npos) throw_usage("LOW,HIGH", text);
            return Range{item<double>(text.substr(0, comma), text),
                         item<double>(text.substr(comma + 1), text)};
        },
        [](const Range& v) { return shown(v.low) + "," + shown(v.high); });
}

}  // namespace

template <typename T>
void OptionTable::add(const std::string& name, T& target, const std::string& help, Use use) {
    options_.push_back({setting_of(name, target, help), use});
}

template <typename Enum>
void OptionTable::add_choice(const std::string& name, Enum& target, const std::string& help,
                             const std::vector<Word<Enum>>& words) {
    options_.push_back({choice_setting(name, target, help, words), Use::learning});
}

OptionTable::OptionTable(TrainOptions& options) {
    add_run_options(options);
    add_network_options(options);
    add_data_options(options);
    add_scene_options(options);
    add_sensor_options(options);
    add_loss_options(options);
    add_schedule_options(options);
}

void OptionTable::add_run_options(TrainOptions& o) {
    add("out", o.out, "folder for the checkpoint, the logs and the images", Use::run);
    add("textures", o.textures, "pack of photographs to learn from; none: procedural textures",
        Use::run);
    add("validation-textures", o.validation_textures, "pack of photographs to validate with",
        Use::run);
    add("lpips", o.lpips, "npz file of LPIPS-Squeeze; none: that loss is left out", Use::run);
    add("minutes", o.minutes, "budget of the whole run, resumed parts included", Use::run);
    add("clock", o.clock, "that --minutes go by: wall, or cpu (all threads; for fair comparisons)",
        Use::run);
    add("steps", o.steps, "budget in steps instead, where not 0", Use::run);
    add("resume", o.resume,
        "checkpoint to go on from; its options are those of its beginning, "
        "unless given again after this one",
        Use::once);
    add("initial", o.initial,
        "model or checkpoint whose weights a new network begins with where names and shapes agree",
        Use::once);
    add("export", o.export_file, "model file to write at the end", Use::once);
    add("keep", o.keep,
        "checkpoint to write at the end without the states of streams, which fill again: for a "
        "repository",
        Use::once);
    add("overwrite", o.overwrite,
        "1: --export and --keep may replace files; --keep also that of --resume", Use::once);
    add("card", o.card, "what the model card says first", Use::run);
    add("device", o.device, "cpu or cuda", Use::run);
    add_choice("precision", o.precision,
               "of activations: f32 or bf16; auto: bf16 where it is quick", kPrecisionWords);
    add("threads", o.threads, "shares of a step computed at the same time");
    add("streams", o.streams, "streams per thread and step");
    add("groups", o.groups, "number of groups of streams; each step trains one");
    add("seed", o.data.seed, "random seed of data and initial weights");
}

void OptionTable::add_network_options(TrainOptions& o) {
    add_choice("encoder", o.model.encoder, "kind of encoder: gated or thesis",
               {{EncoderKind::gated, "gated"}, {EncoderKind::thesis, "thesis"}});
    add("bins", o.model.bins, "B, number of bins of the voxel grid");
    add("inputs", o.inputs,
        "channels of the voxel grid that may be used: polarity,mean,std,count,since");
    add("widths", o.model.widths, "channels per level");
    add("recurrent", o.model.recurrent, "per level: 1 recurrent, 0 held");
    add("reset-gate", o.model.reset_gate, "1: recurrent levels have a reset gate; 0: none");
    add("res-blocks", o.model.res_blocks, "number of residual blocks at the lowest resolution");
    add("gate-radius", o.model.gate_radius, "px around events in which states change");
    add("noise-filter", o.model.noise_filter, "1: events that no neighbours support are left out");
    add("gate-spread", o.model.gate_spread,
        "pixels of the lowest resolution by which the gate reaches further there");
    add("latent", o.model.latent, "D, numbers per latent code");
    add("out-layer", o.model.out_layer,
        "1: a linear layer makes the codes; 0: the last map on the way up is the codes");
    add("latent-stride", o.model.latent_stride, "px between latent samples: 1 or 2");
    add("unfold", o.model.unfold, "codes in y and x that the renderer reads: 3 (3 x 3) or 1");
    add_choice("live-edge", o.model.live_edge,
               "how codes change inside the newest event window: jump or fade",
               {{LiveEdge::jump, "jump"}, {LiveEdge::fade, "fade"}});
    add("mlp", o.model.mlp, "hidden widths of the renderer");
    add_choice("sigma-rule", o.model.sigma_rule,
               "how sigma is blended from latent samples: log_blend or mixture",
               {{SigmaRule::log_blend, "log_blend"}, {SigmaRule::mixture, "mixture"}});
    add_choice("blend", o.model.blend, "weights of latent samples in space: linear or smooth",
               {{Blend::linear, "linear"}, {Blend::smooth, "smooth"}});
}

void OptionTable::add_data_options(TrainOptions& o) {
    add("crop", o.data.crop, "px, side of the part of a sensor that is simulated");
    add("sensor-width", o.data.sensor_width,
        "px, width of that sensor; its height is three quarters of it");
    add("event-windows", o.data.event_windows, "event windows that gradients flow through");
    add("rendered", o.data.rendered,
        "number of those, consecutive, that are compared with the truth");
    add("patch", o.data.patch, "px, side of the patches compared");
    add("on-pixels", o.data.whole_probability, "share of patches whose points are pixels");
    add("points-per-pixel", o.data.span_scale_max, "of the other patches, at most; at least 1");
    add("episode", o.data.episode, "event windows of one scene");
    add("window-s", o.data.window_s, "s, width of event windows");
    add("content-share", o.data.content_share,
        "share of scenes whose event windows end by number of events");
    add("content-epp", o.data.content_epp, "events per pixel that end such a window");
    add("thesis-share", o.data.thesis_share,
        "share of scenes with the thesis' light, threshold and truth");
}

void OptionTable::add_scene_options(TrainOptions& o) {
    add("speed", o.data.scene.wander.speed, "px/s, of scenes");
    add("speed-factor", o.data.scene.wander.pace, "times the speed, drawn anew as a scene goes on");
    add("leg-s", o.data.scene.wander.leg_s, "s, between changes of a scene's heading");
    add("turn", o.data.scene.wander.turn, "rad, deviation of each change");
    add("camera-shake", o.data.scene.wander.tremble,
        "share of scenes and objects that shake about one place instead");
    add("still", o.data.scene.still_background, "share of scenes whose camera stands still");
    add("objects", o.data.scene.objects_max, "moving objects at most");
    add("object-size", o.data.scene.object_size,
        "full length of moving and fixed things, over the sensor's height");
    add("static-objects", o.data.scene.pinned_max, "objects fixed to the background at most");
    add("textureless", o.data.scene.object_flat, "share of objects of one grey value");
    add("low-contrast", o.data.scene.faint_probability, "share of scenes of low contrast");
    add("pauses", o.data.scene.pause_start, "probability that a pause begins, per 50 ms");
    add("light", o.data.scene.white_lux, "lux on the chip where the scene is white");
    add("range", o.data.scene.dynamic_range, "white over black of scenes");
    add("target-mean", o.data.scene.target_mean, "mean of what the exposed camera shows");
    add("target-deviation", o.data.scene.target_deviation, "standard deviation of the same");
    add("target-black", o.data.scene.target_black,
        "level darkness is read out as; below 0: cut off");
    add("saturated", o.data.scene.target_white_below_one, "share of cameras that clip below 1");
    add("light-changes", o.data.scene.light_change_probability,
        "share of scenes whose light changes");
    add("flicker", o.data.scene.flicker_probability, "share of scenes under mains light");
}

void OptionTable::add_sensor_options(TrainOptions& o) {
    add("threshold", o.data.sensor.threshold, "contrast threshold, ln of the light's change");
    add("bandwidth-hz", o.data.sensor.bandwidth_hz, "bandwidth of photoreceptors in bright light");
    add("bandwidth-hz-per-lux", o.data.sensor.bandwidth_hz_per_lux, "of the same in dim light");
    add("shot-hz", o.data.sensor.shot_hz, "noise events per pixel in the dark");
    add("shot-lux", o.data.sensor.shot_lux, "light in which they are half as many");
    add("leak-hz", o.data.sensor.leak_hz, "ON events per pixel without any change");
}

void OptionTable::add_loss_options(TrainOptions& o) {
    add("l1", o.loss.l1, "weight of the L1 term");
    add("l2", o.loss.l2, "weight of the squared error");
    add("ssim", o.loss.ssim, "weight of 1 - SSIM, mean over sizes");
    add("contrast", o.loss.contrast, "weight of 1 - structure and contrast of the whole image");
    add("lpips-weight", o.loss.lpips, "weight of the LPIPS term");
    add("lpips-frames", o.lpips_frames,
        "number of rendered images, the last ones, that LPIPS looks at");
    add("lpips-on-pixels", o.lpips_on_pixels,
        "1: LPIPS looks at all patches; 0: at those between the pixels, so that frames of the "
        "sensor's size stay as they are drawn to the teacher's");
    add("nll", o.loss.nll, "weight of the negative log-likelihood, which never moves mu");
    add("temporal", o.loss.temporal, "weight of the L1 term of changes from image to image");
    add("teacher", o.teacher,
        "model whose frames mu is drawn to, beside the truth; none: the truth alone", Use::run);
    add("teacher-share", o.teacher_share, "share of the teacher's frames in what mu is drawn to");
    add("teacher-views", o.teacher_views,
        "2 or 4: the mean of the teacher's frames of the scene as it is and mirrored, as of "
        "--self-ensemble; 1: as it is");
    add("train-only", o.train_only,
        "what the names of the weights that learn begin with, as in renderer.,encoder.out; none: "
        "all learn");
}

void OptionTable::add_schedule_options(TrainOptions& o) {
    add("rate", o.learning_rate, "largest learning rate");
    add("final-rate", o.final_rate, "last learning rate, as a share of the largest");
    add("constant-share", o.constant_share, "share of the budget before the rate falls");
    add("warm-up", o.warm_up, "steps in which the rate rises");
    add("clip", o.optimiser.clip, "largest norm of a gradient");
    add("ema", o.optimiser.ema_decay, "decay of the running mean of the weights");

    add("checkpoint-minutes", o.checkpoint_minutes, "minutes between checkpoints", Use::run);
    add("validate-minutes", o.validate_minutes, "minutes between validations", Use::run);
    add("log-every", o.log_every, "steps per line of the log", Use::run);
    add("validation-scenes", o.validation_scenes, "number of scenes to judge by");
    add("validation-windows", o.validation_windows, "event windows of each of those scenes");
    add("validation-crop", o.validation_crop, "px, side of the part of a sensor that they show");
}

}  // namespace eventide
