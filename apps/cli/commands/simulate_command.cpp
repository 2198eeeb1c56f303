// eventide simulate: recordings whose truth is known.
#include "apps/cli/commands/simulate_command.h"

#include "apps/cli/commands/command_files.h"
#include "apps/cli/idle_flag.h"
#include "apps/cli/progress.h"
#include "apps/cli/settings/words.h"
#include "apps/cli/terminal.h"
#include "replay/formats.h"
#include "replay/written_data.h"
#include "src/core/error.h"
#include "src/core/grey.h"
#include "src/core/number_text.h"
#include "src/simulate/conditions.h"
#include "src/simulate/presets.h"
#include "src/simulate/scene/textures_folder.h"

#include <spdlog/spdlog.h>

#include <iostream>
#include <limits>

namespace eventide::app {

namespace {

/// Null for a folder.
const Format* format_of(const std::string& path) {
    if (names_folder(path)) return nullptr;
    const Format* format = format_for_writing(path);
    if (format == nullptr)
        throw Error(ErrorKind::usage, "--out " + path +
                                          ": expected a folder (ending in /) or the extension "
                                          "of a format that can be written, such as .aedat4");
    return format;
}

Frame frame_of(const Truth& truth) {
    Frame frame;
    frame.t = truth.t;
    frame.window = {truth.t, truth.t};
    frame.intensity = truth.image;
    return frame;
}

/// Intensity is the luma.
Frame frame_of(const ColourRecording::Truths& truths, std::size_t i) {
    Frame frame = frame_of(truths[0][i]);
    for (float& v : frame.intensity.values()) v = 0;
    for (std::size_t c = 0; c < truths.size(); ++c) {
        frame.colour[c] = truths[c][i].image;
        for (std::size_t k = 0; k < frame.intensity.values().size(); ++k)
            frame.intensity.values()[k] += kLumaBgr[c] * frame.colour[c].values()[k];
    }
    return frame;
}

StreamHeader header_of(const SimRecordingSettings& what) {
    StreamHeader header;
    header.width = what.width;
    header.height = what.height;
    header.sensor_name = "simulated";
    return header;
}

/// Events, and images where the target has a place for them.
Batch held_of(const Batch& batch, const FormatHolds& holds) {
    Batch held;
    held.events = batch.events;
    if (holds.images) held.images = batch.images;
    return held;
}

void print_scenes() {
    for (const SimulationPreset& preset : simulation_presets())
        std::cout << preset.name << std::string(16 - preset.name.size(), ' ') << preset.what
                  << '\n';
}

}  // namespace

std::string SimulateCommand::examples() const {
    return "The truth is what an ideal camera shows, at any rate and size.\n"
           "Examples:\n"
           "  eventide simulate --scene demo --seconds 4 --out recording.aedat4\n"
           "  eventide simulate --scene wide --seed 7 --size 346x260 --out sequence/ --truth "
           "truth/ "
           "--truth-scale 2";
}

SettingTable SimulateCommand::settings() {
    SettingTable table{"simulate", "eventide simulate: recordings whose truth is known.", {}};
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(text_setting("scene", scene_, "NAME", "Scene to simulate; --list shows the names."));
    add(flag_setting("list", list_, "List the scenes, and exit."));
    Setting out =
        path_setting("out", out_, "FILE|FOLDER/",
                     "Where the recording goes: x.aedat4 or another format with images, or "
                     "a folder/ with events.txt, images.txt and images/.");
    out.short_flag = "-o";
    add(std::move(out));
    const auto add_condition = [&](const char* key, std::optional<double>& value, const char* unit,
                                   const char* help) {
        add(open_setting<double>(
            key, value, unit, help, "scene",
            [](const std::string& text) { return parse_number(text, 1e-3, 1e6); },
            [](const double& v) { return show_number(v); }));
    };
    add_condition("lux", lux_, "LUX",
                  "Light on the chip where the scene is white; scene: as it draws it.");
    add_condition("speed", speed_, "PX/S",
                  "Speed of the camera, which that of things follows, pixels a second; scene: as "
                  "it draws it.");
    add_condition("lamp", lamp_, "TIMES",
                  "A lamp in view, so many times as bright as white; scene: none.");
    add(number_setting("seconds", seconds_, "S", "Recording duration, seconds.", 0.001, 1e6));
    add(parsed_setting<Size>("size", size_, "WxH", "Sensor size in pixels.", parse_size,
                             show_size));
    add(parsed_setting<std::string>(
        "seed", seed_, "N",
        "Random seed: the same seed, the same recording; auto: the "
        "scene's own.",
        [](const std::string& text) {
            if (text != "auto") parse_whole(text, 0, std::numeric_limits<int>::max());
            return text;
        },
        [](const std::string& text) { return text; }));
    add(number_setting("images_per_second", images_per_second_, "N",
                       "Reference images in the recording; 0: none.", 0, 1e5));
    add(path_setting("truth", truth_, "FOLDER",
                     "Also write the truth as frames, laid out as the "
                     "folder sink does."));
    add(number_setting("truths_per_second", truths_per_second_, "N", "Rate of the truth.", 0.001,
                       1e5));
    add(number_setting(
        "truth_scale", truth_scale_, "S",
        "Size of the truth: (width - 1) S + 1 columns, so that corners stay corners.", 0.1, 16));
    add(text_setting("textures", textures_, "PATH",
                     "Folder of images or pack of textures to draw the scene from; empty: "
                     "procedural textures."));
    add(choice_setting(
        "bayer", bayer_,
        "A colour camera: the filter before its pixels, from the top left corner. Images are "
        "mosaics, the truth is in colour, and --textures is a folder of colour images.",
        bayer_words()));
    add(flag_setting("overwrite", overwrite_,
                     "Replace files that exist; of a folder, what an earlier run wrote."));
    return table;
}

SimRecordingSettings SimulateCommand::plan() const {
    const SimulationPreset preset =
        under({.lux = lux_, .speed = speed_, .lamp = lamp_}, simulation_preset(scene_));
    SimRecordingSettings plan;
    plan.scene = preset.scene;
    plan.sensor = preset.sensor;
    plan.width = size_.width;
    plan.height = size_.height;
    plan.seed = seed_ == "auto" ? preset.seed : number_in<std::uint64_t>(seed_).value();
    plan.seconds = seconds_;
    plan.images_per_second = images_per_second_;
    plan.truths_per_second = truth_.empty() ? 0 : truths_per_second_;
    plan.truth_scale = truth_scale_;
    return plan;
}

void SimulateCommand::simulate(
    const SimRecordingSettings& what, const ColourRecording::Textures& textures,
    const std::function<bool(const Batch&, std::vector<Frame>&)>& emit) const {
    const ColourFilter filter = bayer_;
    std::vector<Frame> frames;
    if (filter == ColourFilter::none) {
        simulate_recording(what, textures[0],
                           [&](const Batch& batch, const std::vector<Truth>& truths) {
                               frames.clear();
                               for (const Truth& truth : truths) frames.push_back(frame_of(truth));
                               return emit(batch, frames);
                           });
        return;
    }
    ColourRecording recording{what, textures, filter};
    Batch batch;
    ColourRecording::Truths truths;
    while (recording.next(batch, truths)) {
        frames.clear();
        for (std::size_t i = 0; i < truths[0].size(); ++i) frames.push_back(frame_of(truths, i));
        if (!emit(batch, frames)) return;
    }
}

void SimulateCommand::name_output_files(NamedFiles& files) const {
    files.may_replace(overwrite_);
    name_files("--textures", textures_, files);
    if (names_folder(out_))
        name_run_folder("--out", out_, EcdWriter::files(), files);
    else
        files.writes("--out", out_);
    if (!truth_.empty()) name_run_folder("--truth", truth_, FolderSink::files(), files);
}

void SimulateCommand::refuse_what_would_change_nothing(const Program& program) const {
    if (out_.empty())
        throw Error(ErrorKind::usage, "expected --out, such as --out recording.aedat4");
    if (truth_.empty())
        for (const char* key : {"truths_per_second", "truth_scale"})
            refuse_idle_flag(program.flags, key, "--truth FOLDER");
}

ColourRecording::Textures SimulateCommand::textures() const {
    if (bayer_ == ColourFilter::none)
        return {open_textures(textures_, kProceduralTextures), {}, {}};
    if (!std::filesystem::is_directory(textures_))
        throw Error(ErrorKind::usage, "--bayer " + std::string{name_of(bayer_)} +
                                          ": expected --textures and a folder of colour images, "
                                          "found '" +
                                          textures_ + "'");
    return colour_textures_from_folder(textures_);
}

/// What is simulated and cannot be kept.
void SimulateCommand::warn_of_loss(const FormatHolds& holds) const {
    if (images_per_second_ <= 0) return;
    if (!holds.images)
        spdlog::warn("{}: its format cannot hold reference images", out_);
    else if (!holds.colour_filter && bayer_ != ColourFilter::none)
        spdlog::warn("{}", WrittenData::colours_lost_text(out_, bayer_));
}

/// Until the end, or until it is stopped; `truth` may be null.
SimulateCommand::Written SimulateCommand::write(const SimRecordingSettings& what,
                                                const ColourRecording::Textures& textures,
                                                RecordingOut& out, FolderSink* truth,
                                                const std::function<bool()>& goes_on,
                                                bool quiet) const {
    Progress progress{quiet};
    Written written;
    simulate(what, textures, [&](const Batch& batch, std::vector<Frame>& seen) {
        if (const Batch held = held_of(batch, out.holds()); !held.empty()) out.write(held);
        written.events += batch.events.size();
        written.images += out.holds().images ? batch.images.size() : 0;
        for (Frame& view : seen) {
            view.index = written.truths++;
            truth->write(view);
        }
        if (!batch.events.empty())
            progress.show(double(to_us(batch.events.back().t)) / (1e6 * what.seconds));
        const bool is_wanted = out.reader() == PipeReader::takes || truth != nullptr;
        return is_wanted && goes_on();
    });
    progress.clear();
    out.finish();
    if (truth != nullptr) truth->close();
    return written;
}

int SimulateCommand::run(Program& program) {
    if (list_) {
        print_scenes();
        return exit_done;
    }
    refuse_what_would_change_nothing(program);
    name_output_files(program.files);
    const SimRecordingSettings what = plan();
    const ColourRecording::Textures seen = textures();
    StreamHeader header = header_of(what);
    header.colour_filter = bayer_;
    const bool keeps_earlier = would_replace(out_);
    const auto goes_on = [&] {
        if (keeps_earlier && program.signals.stopping()) throw kept_earlier_file(out_);
        return !program.signals.stopping();
    };
    RecordingOut out{
        out_,
        {.overwrite = overwrite_, .give_up = [&program] { return program.signals.stopping(); }},
        format_of(out_),
        header};
    warn_of_loss(out.holds());
    std::optional<FolderSink> truth;
    if (!truth_.empty())
        truth.emplace(FolderSettings{
            .path = truth_, .overwrite = overwrite_, .uncertainty = Uncertainty::none});
    const Written written =
        write(what, seen, out, truth ? &*truth : nullptr, goes_on, program.quiet);
    const bool is_read = out.reader() == PipeReader::takes;
    if (is_read && program.signals.stopping())
        spdlog::warn("{}: stopped before the end; it holds what was simulated until then", out_);
    spdlog::info("{}: {}", out_,
                 is_read
                     ? counted(written.events, "event") + ", " + counted(written.images, "image")
                     : text_of(out.reader()));
    if (truth) spdlog::info("{}: {}", truth_, counted(written.truths, "frame"));
    return exit_done;
}

}  // namespace eventide::app
