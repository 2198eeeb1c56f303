#include "apps/train/options.h"

#include "src/core/error.h"

#include <algorithm>
#include <array>
#include <sstream>

namespace eventide {
namespace {

void read_value(const std::string& text, std::string& value) {
    value = text;
}
template <typename T>
void read_value(const std::string& text, T& value) {
    std::istringstream in{text};
    if (!(in >> value) || !(in >> std::ws).eof()) throw std::invalid_argument{"a number"};
}
void read_value(const std::string& text, std::vector<int>& value) {
    value.clear();
    std::istringstream in{text};
    for (std::string part; std::getline(in, part, ',');) read_value(part, value.emplace_back());
}
void read_value(const std::string& text, std::vector<std::string>& value) {
    value.clear();
    std::istringstream in{text};
    for (std::string part; std::getline(in, part, ',');) value.push_back(part);
}
void read_value(const std::string& text, Range& value) {
    const auto comma = text.find(',');
    if (comma == text.npos) throw std::invalid_argument{"LOW,HIGH"};
    read_value(text.substr(0, comma), value.low);
    read_value(text.substr(comma + 1), value.high);
}
void read_value(const std::string& text, EncoderKind& value) {
    if (text != "gated" && text != "thesis") throw std::invalid_argument{"gated or thesis"};
    value = text == "gated" ? EncoderKind::gated : EncoderKind::thesis;
}
void read_value(const std::string& text, SigmaRule& value) {
    if (text != "log_blend" && text != "mixture")
        throw std::invalid_argument{"log_blend or mixture"};
    value = text == "mixture" ? SigmaRule::mixture : SigmaRule::log_blend;
}
void read_value(const std::string& text, Blend& value) {
    if (text != "linear" && text != "smooth") throw std::invalid_argument{"linear or smooth"};
    value = text == "smooth" ? Blend::smooth : Blend::linear;
}

template <typename T>
std::string write_value(const T& value) {
    std::ostringstream out;
    out << value;
    return out.str();
}
std::string write_value(const std::vector<int>& value) {
    std::string text;
    for (const int v : value) text += (text.empty() ? "" : ",") + std::to_string(v);
    return text;
}
std::string write_value(const std::vector<std::string>& value) {
    std::string text;
    for (const std::string& v : value) text += (text.empty() ? "" : ",") + v;
    return text;
}
std::string write_value(const Range& value) {
    return write_value(value.low) + "," + write_value(value.high);
}
std::string write_value(const EncoderKind& value) {
    return value == EncoderKind::gated ? "gated" : "thesis";
}
std::string write_value(const SigmaRule& value) {
    return value == SigmaRule::mixture ? "mixture" : "log_blend";
}
std::string write_value(const Blend& value) {
    return value == Blend::smooth ? "smooth" : "linear";
}
void read_value(const std::string& text, LiveEdge& value) {
    if (text != "jump" && text != "fade") throw std::invalid_argument{"jump or fade"};
    value = text == "fade" ? LiveEdge::fade : LiveEdge::jump;
}
std::string write_value(const LiveEdge& value) {
    return value == LiveEdge::fade ? "fade" : "jump";
}

}  // namespace

template <typename T>
void OptionTable::add(const std::string& name, T& target, const std::string& help, Use use) {
    options_.push_back({name, help, use,
                        [&target](const std::string& text) { read_value(text, target); },
                        [&target] { return write_value(target); }});
}

OptionTable::OptionTable(TrainOptions& o) {
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
    add("card", o.card, "what the model card says first", Use::run);
    add("device", o.device, "cpu or cuda", Use::run);
    add("precision", o.precision, "of activations: f32, bf16 or auto (bf16 where it is quick)");
    add("threads", o.threads, "shares of a step computed at the same time");
    add("streams", o.streams, "streams per thread and step");
    add("groups", o.groups, "of streams, that take turns from step to step");
    add("seed", o.data.seed, "of the data and the first weights");

    add("encoder", o.model.encoder, "gated or thesis");
    add("bins", o.model.bins, "B of the voxel grid");
    add("inputs", o.inputs,
        "channels of the voxel grid that may be used: polarity,mean,std,count,since");
    add("widths", o.model.widths, "channels per level");
    add("recurrent", o.model.recurrent, "per level: 1 recurrent, 0 held");
    add("res-blocks", o.model.res_blocks, "at the lowest resolution");
    add("gate-radius", o.model.gate_radius, "px around events in which states change");
    add("noise-filter", o.model.noise_filter, "1: events that no neighbours support are left out");
    add("gate-spread", o.model.gate_spread, "further at the lowest resolution, in its pixels");
    add("latent", o.model.latent, "D");
    add("latent-stride", o.model.latent_stride, "1 or 2");
    add("unfold", o.model.unfold, "codes in y and x that the renderer reads: 3 (3 x 3) or 1");
    add("live-edge", o.model.live_edge, "inside the newest event window: jump or fade");
    add("mlp", o.model.mlp, "hidden widths of the renderer");
    add("sigma-rule", o.model.sigma_rule, "log_blend or mixture");
    add("blend", o.model.blend, "weights of latent samples in space: linear or smooth");

    add("crop", o.data.crop, "px, side of the part of a sensor that is simulated");
    add("sensor-width", o.data.sensor_width,
        "px, of that sensor; its height is three quarters of it");
    add("frames", o.data.frames, "event windows that gradients flow through");
    add("rendered", o.data.rendered, "of them compared with the truth");
    add("patch", o.data.patch, "px, side of the patches compared");
    add("episode", o.data.episode, "event windows of one scene");
    add("frame-s", o.data.frame_s, "s, width of event windows");
    add("content-share", o.data.content_share,
        "share of scenes whose event windows end by number of events");
    add("content-epp", o.data.content_epp, "events per pixel that end such a window");
    add("thesis-share", o.data.thesis_share,
        "share of scenes with the thesis' light, threshold and truth");
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
    add("light-changes", o.data.scene.light_change_probability, "share of scenes");
    add("flicker", o.data.scene.flicker_probability, "share of scenes under mains light");
    add("threshold", o.data.sensor.threshold, "ln of the light's change");
    add("shot-hz", o.data.sensor.shot_hz, "noise events per pixel in the dark");
    add("shot-lux", o.data.sensor.shot_lux, "light in which they are half as many");
    add("leak-hz", o.data.sensor.leak_hz, "ON events per pixel without any change");

    add("l1", o.loss.l1, "weight in the loss");
    add("l2", o.loss.l2, "weight in the loss");
    add("ssim", o.loss.ssim, "weight in the loss");
    add("contrast", o.loss.contrast, "weight in the loss");
    add("lpips-weight", o.loss.lpips, "weight in the loss");
    add("lpips-frames", o.lpips_frames, "of the rendered ones, the last, that LPIPS looks at");
    add("nll", o.loss.nll, "weight in the loss");
    add("temporal", o.loss.temporal, "weight in the loss");
    add("rate", o.learning_rate, "largest learning rate");
    add("final-rate", o.final_rate, "last learning rate, as a share of the largest");
    add("constant-share", o.constant_share, "share of the budget before the rate falls");
    add("warm-up", o.warm_up, "steps in which the rate rises");
    add("clip", o.optimiser.clip, "largest norm of a gradient");
    add("ema", o.optimiser.ema_decay, "decay of the running mean of the weights");

    add("checkpoint-minutes", o.checkpoint_minutes, "between checkpoints", Use::run);
    add("validate-minutes", o.validate_minutes, "between validations", Use::run);
    add("log-every", o.log_every, "steps per line of the log", Use::run);
    add("validation-scenes", o.validation_scenes, "number of scenes to judge by");
    add("validation-frames", o.validation_frames, "event windows of each");
    add("validation-crop", o.validation_crop, "px, side of each");
}

void OptionTable::set(const std::string& name, const std::string& value) {
    // Checkpoints keep the options of their run; the older ones have these names.
    static const std::map<std::string, std::string> kFormerNames{
        {"lanes", "streams"},         {"pace", "speed-factor"}, {"tremble", "camera-shake"},
        {"pinned", "static-objects"}, {"flat", "textureless"},  {"faint", "low-contrast"}};
    const auto former = kFormerNames.find(name);
    const std::string& now = former == kFormerNames.end() ? name : former->second;
    for (const Option& option : options_) {
        if (option.name != now) continue;
        try {
            option.read(value);
        } catch (const std::invalid_argument& expected) {
            throw Error(ErrorKind::usage,
                        "--" + name + ": expected " + expected.what() + ", found '" + value + "'");
        }
        return;
    }
    throw Error(ErrorKind::usage, "expected one of the options of --help, found '--" + name + "'");
}

void OptionTable::parse(const std::vector<std::string>& words) {
    for (std::size_t i = 0; i < words.size(); i += 2) {
        if (!words[i].starts_with("--"))
            throw Error(ErrorKind::usage, "expected --NAME, found '" + words[i] + "'");
        if (i + 1 == words.size())
            throw Error(ErrorKind::usage, words[i] + ": expected a value, found none");
        set(words[i].substr(2), words[i + 1]);
    }
}

std::string OptionTable::help() const {
    std::string text = "eventide-train [--NAME VALUE]...\n";
    for (const Option& option : options_) {
        std::string line = "  --" + option.name + " ";
        line.resize(std::max<std::size_t>(line.size(), 24), ' ');
        text += line + option.help + " (" + option.write() + ")\n";
    }
    return text;
}

std::string OptionTable::record() const {
    std::string text;
    for (const Option& option : options_)
        if (option.use != Use::once && !option.write().empty())
            text += "--" + option.name + " " + option.write() + "\n";
    return text;
}

std::string OptionTable::settings() const {
    std::string text;
    for (const Option& option : options_)
        if (option.use == Use::learning && !option.write().empty())
            text += (text.empty() ? "--" : " --") + option.name + " " + option.write();
    return text;
}

}  // namespace eventide
