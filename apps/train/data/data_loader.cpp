#include "apps/train/data/data_loader.h"

#include "src/binning/binner.h"
#include "src/binning/noise_filter.h"
#include "src/simulate/presets.h"
#include "src/simulate/simulated_stream.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace eventide {
namespace {

constexpr std::size_t kSegmentsAhead = 3;

std::uint64_t seed_of(const DataSettings& settings, std::uint64_t a, std::uint64_t b) {
    return Random{settings.seed + 0x9e3779b97f4a7c15ULL * (a + 1)}.bits() ^
           Random { b + 0xd1b54a32d192ed03ULL }.bits();
}

}  // namespace

SceneSettings DataSettings::training_scenes() {
    SceneSettings scene;
    scene.wander.speed = {6, 600};
    scene.wander.usual = 0;  // every scene's speed is drawn from that range
    scene.still_background = .08;
    scene.objects_max = 16;
    scene.objects_skew = 3;
    scene.faint_probability = .05;
    return scene;
}

SegmentPlan segment_plan(const DataSettings& settings, std::int64_t segment) {
    Random random{seed_of(settings, 0, std::uint64_t(segment))};
    SegmentPlan plan;
    plan.first_rendered = random.integer(0, settings.event_windows - settings.rendered);
    const double whole = settings.crop - 1;
    const double one_to_one = std::min(whole, settings.patch - 1.0);
    plan.on_pixels = random.chance(settings.whole_probability);
    plan.span = one_to_one;
    if (!plan.on_pixels) plan.span /= random.log_uniform({1, settings.span_scale_max});
    plan.y0 = random.uniform() * (whole - plan.span);
    plan.x0 = random.uniform() * (whole - plan.span);
    if (plan.on_pixels) {
        plan.y0 = std::round(plan.y0);
        plan.x0 = std::round(plan.x0);
    }
    for (int i = 0; i < settings.rendered; ++i) {
        const double u = random.uniform();
        plan.lookahead.push_back(u < .5 ? 0 : u < .7 ? 1 : 2);
    }
    return plan;
}

namespace {

/// What an episode's scene and camera are drawn from.
struct Camera {
    SceneSettings scene;
    SensorSettings sensor;
};

/// A sensor of random size, and where in it the crop lies.
SensorPart draw_part(const DataSettings& settings, Random& random) {
    const double width = random.log_uniform(settings.sensor_width);
    SensorPart part{.width = settings.crop, .height = settings.crop};
    part.whole_width = std::max(settings.crop, int(std::lround(width)));
    part.whole_height = std::max(settings.crop, int(std::lround(width * 3 / 4)));
    part.x0 = random.integer(0, part.whole_width - part.width);
    part.y0 = random.integer(0, part.whole_height - part.height);
    return part;
}

/// The thesis' light, threshold and truth (the image itself, whatever its brightness); half of
/// these scenes move as the thesis', half as all others, since the thesis' motion is slow.
Camera thesis_camera(const DataSettings& settings, Random& random) {
    const SimulationPreset& preset = simulation_preset("thesis_train");
    Camera camera{preset.scene, preset.sensor};
    if (random.chance(.5)) return camera;
    camera.scene.background = BackgroundMotion::wander;
    camera.scene.wander = settings.scene.wander;
    camera.scene.pause_start = settings.scene.pause_start;
    return camera;
}

Camera draw_camera(const DataSettings& settings, Random& random) {
    // A share of 0 draws nothing, so that runs of before go on as they were.
    if (settings.thesis_share > 0 && random.chance(settings.thesis_share))
        return thesis_camera(settings, random);
    return {settings.scene, settings.sensor};
}

}  // namespace

/// One scene, its camera and its clock.
struct SceneStream::Episode {
    Episode(const DataSettings& settings, std::shared_ptr<const TextureLibrary> textures,
            std::uint64_t seed)
        : random(seed),
          camera(draw_camera(settings, random)),
          part(draw_part(settings, random)),
          stream(camera.scene, camera.sensor, std::move(textures), part, random.bits()),
          binner(settings.bins, settings.crop, settings.crop),
          grid(binner.make_output()),
          width_s(random.log_uniform(settings.window_s)),
          jitter(random.chance(settings.jitter_probability) ? settings.window_jitter : 0) {
        // A share of 0 draws nothing, so that runs of before go on as they were.
        if (settings.content_share > 0 && random.chance(settings.content_share))
            enough = random.log_uniform(settings.content_epp) * settings.crop * settings.crop;
        if (settings.noise_filter)
            noise_filter.emplace(settings.crop, settings.crop, NoiseFilterSettings{});
        if (settings.teacher_bins == 0) return;
        teacher_binner.emplace(settings.teacher_bins, settings.crop, settings.crop);
        teacher_grid = teacher_binner->make_output();
    }

    void advance() {
        const double s = width_s * std::exp(jitter * (2 * random.uniform() - 1));
        const double us = enough > 0 ? std::min(s * 1e6, width_by_content()) : s * 1e6;
        const SensorDuration width{std::max<std::int64_t>(1, std::llround(us))};
        window = {stream.now(), stream.now() + width};
        events.clear();
        stream.advance(window.end, events);
        if (noise_filter) noise_filter->process(events);
        binner.process({.window = window, .events = events}, grid);
        if (teacher_binner)
            teacher_binner->process({.window = window, .events = events}, teacher_grid);
        ++event_windows;
    }

    /// us; foreseen from the rate of the window before, so that each is simulated in one step.
    double width_by_content() const {
        constexpr double kLeast = 1e3, kGrowth = 2;
        const double before = event_windows == 0 ? kLeast : double(window.width().count());
        const double by_rate = before * enough / std::max(1.0, double(events.size()));
        return std::max(kLeast, std::min(by_rate, kGrowth * before));
    }

    Random random;
    Camera camera;
    SensorPart part;
    SimulatedStream stream;
    Binner binner;
    VoxelGrid grid;
    std::optional<Binner> teacher_binner;  ///< where a teacher's bins are others
    VoxelGrid teacher_grid;
    double width_s, jitter;
    std::optional<NoiseFilter> noise_filter;
    double enough = 0;  ///< events that end a window before its time; 0: none do
    Window window;
    std::vector<Event> events;
    int event_windows = 0;
};

SceneStream::SceneStream(const DataSettings& settings,
                         std::shared_ptr<const TextureLibrary> textures, StreamPlace place,
                         std::int64_t first_segment)
    : settings_(settings), textures_(std::move(textures)), place_(place) {
    // Turns of this stream before the run's segment `first_segment`.
    const std::int64_t first = (first_segment - place.group + place.groups - 1) / place.groups;
    // Scenes that are over are skipped; the one under way is simulated again up to the segment.
    start_episode();
    while (segment_ + segments_left_ <= first) {
        segment_ += segments_left_;
        start_episode();
    }
    while (segment_ < first) next();
}

SceneStream::~SceneStream() = default;

void SceneStream::start_episode() {
    ++episode_;
    now_.reset();
    Random random{seed_of(settings_, std::uint64_t(place_.stream) + 1, std::uint64_t(episode_))};
    const double event_windows = random.log_uniform(settings_.episode);
    segments_left_ =
        std::max<std::int64_t>(1, std::llround(event_windows / settings_.event_windows));
}

void SceneStream::open_episode() {
    now_ = std::make_unique<Episode>(
        settings_, textures_,
        ~seed_of(settings_, std::uint64_t(place_.stream) + 1, std::uint64_t(episode_)));
}

StreamSegment SceneStream::next() {
    if (segments_left_ == 0) start_episode();
    StreamSegment out;
    out.fresh = now_ == nullptr;
    if (out.fresh) open_episode();
    const SegmentPlan plan = segment_plan(settings_, segment_ * place_.groups + place_.group);
    Episode& episode = *now_;
    for (int k = 0; k < settings_.event_windows; ++k) {
        episode.advance();
        out.grids.push_back(episode.grid.values);
        if (episode.teacher_binner) out.teacher_grids.push_back(episode.teacher_grid.values);
        if (k < plan.first_rendered || k >= plan.first_rendered + settings_.rendered) continue;
        const bool edge = episode.random.chance(settings_.edge_probability);
        const auto width = episode.window.width().count();
        const auto part = std::clamp<std::int64_t>(
            edge ? width : std::llround(episode.random.uniform() * double(width)), 1, width);
        out.f.push_back(float(double(part) / double(width)));
        out.weight.push_back(episode.event_windows > settings_.warm_windows ? 1.0F : 0.0F);
        out.truth.emplace_back(settings_.patch, settings_.patch);
        episode.stream.truth(episode.window.begin + SensorDuration{part}, plan.y0, plan.x0,
                             plan.span, plan.span, out.truth.back());
    }
    ++segment_;
    --segments_left_;
    return out;
}

DataLoader::DataLoader(const DataSettings& settings, std::shared_ptr<const TextureLibrary> textures,
                       int streams, int groups, std::int64_t first_segment,
                       SimulatorPriority priority)
    : settings_(settings),
      textures_(std::move(textures)),
      priority_(priority),
      streams_(streams),
      groups_(groups),
      segment_(first_segment),
      slots_(std::size_t(streams * groups)) {
    for (int stream = 0; stream < streams * groups; ++stream) {
        const StreamPlace place{stream, stream / streams, groups};
        threads_.emplace_back([this, place, first_segment](const std::stop_token& stop) {
            simulate(stop, place, first_segment);
        });
    }
}

DataLoader::~DataLoader() = default;

void DataLoader::simulate(const std::stop_token& stop, StreamPlace place,
                          std::int64_t first_segment) {
    Slot& slot = slots_[std::size_t(place.stream)];
    if (priority_ == SimulatorPriority::behind) setpriority(PRIO_PROCESS, 0, 19);  // this thread's
    try {
        SceneStream source{settings_, textures_, place, first_segment};
        while (!stop.stop_requested()) {
            StreamSegment segment = source.next();
            std::unique_lock lock{mutex_};
            if (!changed_.wait(lock, stop, [&] { return slot.ready.size() < kSegmentsAhead; }))
                return;
            slot.ready.push_back(std::move(segment));
            changed_.notify_all();
        }
    } catch (...) {
        const std::lock_guard lock{mutex_};
        slot.failure = std::current_exception();
        changed_.notify_all();
    }
}

std::vector<StreamSegment> DataLoader::next() {
    std::vector<StreamSegment> segments;
    std::unique_lock lock{mutex_};
    const auto group = std::size_t(segment_++ % groups_), streams = std::size_t(streams_);
    for (Slot& slot : std::span{slots_}.subspan(group * streams, streams)) {
        changed_.wait(lock, [&] { return !slot.ready.empty() || slot.failure; });
        if (slot.ready.empty()) std::rethrow_exception(slot.failure);
        segments.push_back(std::move(slot.ready.front()));
        slot.ready.pop_front();
    }
    changed_.notify_all();
    return segments;
}

}  // namespace eventide
