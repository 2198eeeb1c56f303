// Training data, simulated while training goes on: endless streams of event windows with the truth.
#pragma once

#include "src/core/array.h"
#include "src/simulate/scene/scene_settings.h"
#include "src/simulate/scene/textures.h"
#include "src/simulate/sensor/sensor_settings.h"

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace eventide {

struct DataSettings {
    int bins = 5;
    int teacher_bins = 0;  ///< of grids of the same events for a teacher; 0: it reads those
    int crop = 64;         ///< px, side of the part of a sensor that is simulated
    /// px, log-uniform per episode; width of that sensor, whose height is three quarters of it.
    /// Never smaller than the crop.
    Range sensor_width{128, 346};
    int event_windows = 8;   ///< per segment, which is what a step sees: gradients flow through one
    int rendered = 4;        ///< of them, consecutive, are compared with the truth
    int patch = 64;          ///< px, side of the images compared
    Range episode{20, 400};  ///< log-uniform; event windows until a stream starts anew
    Range window_s{.01, .1};         ///< log-uniform per episode; width of the event windows
    double window_jitter = .3;       ///< ln; widths within an episode differ by up to this ...
    double jitter_probability = .5;  ///< ... in this share of the episodes
    double whole_probability = .6;   ///< patches whose points are pixels
    double span_scale_max = 4;       ///< else log-uniform 1..this points per pixel
    double edge_probability = .4;    ///< images at the end of their event window; else anywhere
    int warm_windows = 4;            ///< of a new stream, that count nothing
    double content_share = 0;        ///< episodes whose windows end by content, too:
    Range content_epp{.2, 1};        ///< log-uniform; at so many events per pixel, never under 1 ms
    bool noise_filter = false;       ///< events are left out as NoiseFilter does
    double thesis_share = 0;  ///< episodes lit, sensed and shown as the thesis' (see `Camera`)
    std::uint64_t seed = 1;
    SceneSettings scene = training_scenes();
    SensorSettings sensor;

    /// The simulator's own ranges, less of what shows next to nothing: a scene that stands still
    /// from the beginning cannot be learned from.
    static SceneSettings training_scenes();
};

/// What all streams of one segment share, so that they are computed together.
struct SegmentPlan {
    int first_rendered = 0;           ///< of its event windows
    bool on_pixels = true;            ///< the patch's points are pixels
    double y0 = 0, x0 = 0, span = 0;  ///< px, of the patch
    std::vector<int> lookahead;       ///< per rendered one: 0, 1 or 2
};
SegmentPlan segment_plan(const DataSettings& settings, std::int64_t segment);

/// One stream's part of a segment.
struct StreamSegment {
    bool fresh = false;                        ///< a new scene: the state before it is empty
    std::vector<Array3<float>> grids;          ///< per event window, [y][x][channel]
    std::vector<Array3<float>> teacher_grids;  ///< the same; empty where teacher_bins is 0
    std::vector<float> f;              ///< per rendered frame, instant in the event window (0, 1]
    std::vector<float> weight;         ///< per rendered frame
    std::vector<Array2<float>> truth;  ///< per rendered frame, patch x patch
};

/// Which stream, and how often its turn comes: segment n of the run is made of the streams of group
/// n % groups. Neighbouring steps then see other scenes, and scenes may be long all the same.
struct StreamPlace {
    int stream = 0;
    int group = 0, groups = 1;
};

/// Segments of one stream, one after the other; the same for the same settings and place.
class SceneStream {
public:
    /// Goes on where the run is at `first_segment`.
    SceneStream(const DataSettings& settings, std::shared_ptr<const TextureLibrary> textures,
                StreamPlace place, std::int64_t first_segment);
    ~SceneStream();

    StreamSegment next();

private:
    struct Episode;
    void start_episode();
    void open_episode();

    DataSettings settings_;
    std::shared_ptr<const TextureLibrary> textures_;
    StreamPlace place_;
    std::int64_t segment_ = 0, episode_ = -1, segments_left_ = 0;
    std::unique_ptr<Episode> now_;
};

/// Many streams must not hold up the one thread that feeds a GPU: theirs can be of the lowest
/// priority.
enum class SimulatorPriority { same, behind };

/// Streams that simulate ahead on threads of their own, a bounded number of segments.
class DataLoader {
public:
    /// `streams` in each of `groups`.
    DataLoader(const DataSettings& settings, std::shared_ptr<const TextureLibrary> textures,
               int streams, int groups, std::int64_t first_segment,
               SimulatorPriority priority = SimulatorPriority::same);
    ~DataLoader();

    /// The next segment of the streams whose turn it is; waits. Rethrows what a stream threw.
    std::vector<StreamSegment> next();

private:
    struct Slot {
        std::deque<StreamSegment> ready;
        std::exception_ptr failure;
    };
    void simulate(const std::stop_token& stop, StreamPlace place, std::int64_t first_segment);

    DataSettings settings_;
    std::shared_ptr<const TextureLibrary> textures_;
    SimulatorPriority priority_;
    int streams_, groups_;
    std::int64_t segment_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::vector<Slot> slots_;            // by mutex_
    std::vector<std::jthread> threads_;  // last: they stop before the rest goes
};

}  // namespace eventide
