#include "apps/train/sound_options.h"

#include "apps/train/blas.h"
#include "src/core/error.h"
#include "src/io/named_files.h"
#include "src/model/model_metadata.h"
#include "src/settings/values.h"

#include <filesystem>
#include <limits>
#include <utility>

namespace eventide {
namespace {

/// px, of what SSIM's window and the perceptual network's layers still fit into.
constexpr int kLeastForSsim = 11, kLeastForLpips = 17;

void need(const char* option, int found, int low, int high = std::numeric_limits<int>::max()) {
    if (found >= low && found <= high) return;
    const std::string most =
        high < std::numeric_limits<int>::max() ? " to " + std::to_string(high) : " or more";
    throw Error(ErrorKind::usage, std::string{option} + ": expected " + std::to_string(low) + most +
                                      ", found " + std::to_string(found));
}

void need(const char* option, bool holds, const char* expected, double found) {
    if (!holds)
        throw Error(ErrorKind::usage, std::string{option} + ": expected " + expected + ", found " +
                                          show_number(found));
}

void need_share(const char* option, double found) {
    need(option, found >= 0 && found <= 1, "0 to 1", found);
}

/// A model file of such a network could not be written.
void need_network(const ModelConfig& model) {
    try {
        check_config(model, "the network asked for");
    } catch (const Error& error) {
        throw Error(ErrorKind::usage, error.what());
    }
}

void need_sizes(const TrainOptions& options) {
    const int least =
        !options.lpips.empty() && options.loss.lpips > 0 ? kLeastForLpips : kLeastForSsim;
    need("--threads", options.threads, 1);
    need("--streams", options.streams, 1);
    need("--groups", options.groups, 1);
    need("--crop", options.data.crop, 2);
    need("--patch", options.data.patch, least);
    const double points = options.data.span_scale_max;
    need("--points-per-pixel", points >= 1, "1 or more", points);
    need("--event-windows", options.data.event_windows, 1);
    need("--rendered", options.data.rendered, 1, options.data.event_windows);
    if (options.teacher_views != 1 && options.teacher_views != 2 && options.teacher_views != 4)
        throw Error(ErrorKind::usage, "--teacher-views: expected 1, 2 or 4, found " +
                                          std::to_string(options.teacher_views));
    need_share("--teacher-share", options.teacher_share);
    need("--lpips-frames", options.lpips_frames, 1);
    need("--log-every", options.log_every, 1);
    if (options.validation_scenes <= 0) return;
    need("--validation-crop", options.validation_crop, least);
    // The first of a scene count nothing.
    need("--validation-windows", options.validation_windows, options.data.warm_windows + 1);
}

/// Budget, rate and means over steps.
void need_schedule(const TrainOptions& options) {
    const double rate = options.learning_rate, clip = options.optimiser.clip;
    need("--steps", options.steps, 0);
    need("--minutes", options.minutes >= 0, "0 or more", options.minutes);
    need("--rate", rate >= 0, "0 or more", rate);
    need_share("--final-rate", options.final_rate);
    need_share("--constant-share", options.constant_share);
    need("--warm-up", options.warm_up, 0);
    need("--clip", clip > 0, "more than 0", clip);
    need_share("--ema", options.optimiser.ema_decay);
}

/// Hours of training, and the best of them would pass for this run's.
void need_own_folder(const TrainOptions& options) {
    if (!options.initial.empty() && !options.resume.empty())
        throw Error(ErrorKind::usage, "--initial: expected no --resume, found both");
    const auto other = std::filesystem::path{options.out} / kCheckpoint;
    if (options.resume.empty() && std::filesystem::exists(other))
        throw Error(ErrorKind::usage, "--out " + options.out + ": holds another run; --resume " +
                                          other.string() + " goes on with it");
}

/// What the run reads is never what it writes, but for the checkpoint that it goes on from: that is
/// its own, and --keep may write it anew.
void need_own_files(const TrainOptions& options) {
    NamedFiles files;
    const std::filesystem::path out{options.out}, checkpoint = out / kCheckpoint;
    for (const auto& [option, path] : {std::pair{"--textures", &options.textures},
                                       {"--validation-textures", &options.validation_textures},
                                       {"--lpips", &options.lpips},
                                       {"--teacher", &options.teacher},
                                       {"--initial", &options.initial}})
        files.reads(option, *path);
    const auto goes_on_in = [&](const std::filesystem::path& path) {
        return !path.empty() &&
               FileIdentity::of(path).is_same_file(FileIdentity::of(options.resume));
    };
    if (!options.resume.empty() && !goes_on_in(checkpoint) && !goes_on_in(options.keep))
        files.reads("--resume", options.resume);
    files.may_replace(true);
    files.expect_folder("--out", out);
    for (const std::filesystem::path& own : {checkpoint, out / kBest}) files.writes("--out", own);
    files.may_replace(options.overwrite);
    files.writes_when_done("--export", options.export_file);
    files.writes_when_done("--keep", options.keep);
}

}  // namespace

const TrainOptions& sound(const TrainOptions& options) {
    if (options.clock != "wall" && options.clock != "cpu")
        throw Error(ErrorKind::usage,
                    "--clock: expected wall or cpu, found '" + options.clock + "'");
    need_sizes(options);
    need_schedule(options);
    need_network(options.model);
    require_blas_for_threads(options.threads);
    need_own_folder(options);
    need_own_files(options);
    return options;
}

}  // namespace eventide
