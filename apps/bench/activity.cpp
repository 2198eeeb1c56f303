// See activity.h.
#include "apps/bench/activity.h"

#include "src/binning/binner.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"

#include <algorithm>
#include <cmath>

namespace eventide::bench {
namespace {

constexpr SensorDuration kWindow{50'000};
constexpr int kWarm = 8;  // windows until every buffer has been filled, and what is still is still

/// The windows' events within a square of this share of the sensor.
std::vector<VoxelGrid> grids_of(const std::vector<SceneWindow>& windows, double moving, int bins,
                                const StageSettings& s) {
    const double side = std::sqrt(moving);
    const auto inside = [&](int at, int size) {
        return std::abs(at + .5 - size / 2.0) <= side * size / 2;
    };
    Binner binner{bins, s.height, s.width};
    std::vector<VoxelGrid> grids;
    for (SceneWindow window : windows) {
        std::erase_if(window.events, [&](const Event& event) {
            return !inside(event.x, s.width) || !inside(event.y, s.height);
        });
        binner.process(window.event_window(), grids.emplace_back(binner.make_output()));
    }
    return grids;
}

/// An encoder and a renderer behind it, fed with the same windows again and again.
class PipelineUnderTest {
public:
    PipelineUnderTest(const Model& model, const StageSettings& s, const EngineOptions& engine)
        : encoder_{model, s.width, s.height, engine},
          renderer_{model, s.width, s.height, engine},
          latents_(3) {
        for (LatentMap& latent : latents_) latent = encoder_.make_output();
        request_.width = int(std::lround(s.width * s.scale));
        request_.height = int(std::lround(s.height * s.scale));
        request_.lookahead = s.lookahead;
        frame_ = renderer_.make_output(request_);
    }

    const Encoder& encoder() const { return encoder_; }
    const LatentMap& latent() const { return latents_[std::size_t(step_) % latents_.size()]; }
    const Frame& frame() const { return frame_; }

    void encode(VoxelGrid& grid) {
        ++step_;
        grid.window = {kWindow * (step_ - 1) + SensorTime{}, kWindow * step_ + SensorTime{}};
        encoder_.encode(grid, latents_[std::size_t(step_) % latents_.size()]);
    }
    void push() { renderer_.push(latent()); }
    /// A place in the newest window that can be rendered.
    void render(int thousandths) {
        request_.t =
            latent().window.end - kWindow * (request_.lookahead + 1) + kWindow * thousandths / 1000;
        if (renderer_.ready(request_.t, request_.lookahead)) renderer_.render(request_, frame_);
    }

private:
    Encoder encoder_;
    Renderer renderer_;
    std::vector<LatentMap> latents_;
    RenderRequest request_;
    Frame frame_;
    int step_ = 0;
};

class ErrorSum {
public:
    void add(const Frame& frame, const Frame& truth) {
        const auto &a = frame.intensity.values(), &b = truth.intensity.values();
        for (std::size_t i = 0; i < a.size(); ++i) {
            const double d = double(a[i]) - double(b[i]);
            most_ = std::max(most_, std::abs(d));
            squares_ += d * d;
        }
        count_ += double(a.size());
    }
    FrameError error() const { return {most_, count_ > 0 ? std::sqrt(squares_ / count_) : 0}; }

private:
    double most_ = 0, squares_ = 0, count_ = 0;
};

double changed_share(const LatentHistory& history) {
    return double(std::ranges::count(history.changed, history.step)) /
           double(history.changed.size());
}

/// Both lines see a dense scene first, then the part that moves.
template <typename Body>
void run(std::vector<VoxelGrid>& dense, std::vector<VoxelGrid>& grids, int repetitions,
         const Body& body) {
    for (int i = 0; i < kWarm; ++i) body(dense[std::size_t(i) % dense.size()], false);
    for (int i = 0; i < kWarm + repetitions; ++i)
        body(grids[std::size_t(i) % grids.size()], i >= kWarm);
}

void measure_frames(const Model& model, const StageSettings& s, std::vector<VoxelGrid>& dense,
                    std::vector<VoxelGrid>& grids, bool is_anywhere, ActivityRow& row) {
    EngineOptions engine = s.engine, without = s.engine;
    if (!is_anywhere) engine.still_codes = engine.still_time = 0;
    without.skip_quiet = false;
    PipelineUnderTest tested{model, s, engine}, judge{model, s, without};
    Stopwatch encoding, rendering;
    ErrorSum error;
    int place = 600;
    row.engine = tested.encoder().description();
    run(dense, grids, s.repetitions, [&](VoxelGrid& grid, bool counts) {
        if (is_anywhere) place = (place + 370) % 1000;
        if (counts) encoding.start();
        tested.encode(grid);
        if (counts) encoding.stop(), rendering.start();
        tested.push();
        tested.render(place);
        if (counts) rendering.stop();
        judge.encode(grid);
        judge.push();
        judge.render(place);
        if (!counts) return;
        error.add(tested.frame(), judge.frame());
        row.is_encode_exact &=
            std::ranges::equal(tested.latent().values.values(), judge.latent().values.values());
        row.changed = changed_share(tested.latent().history);
    });
    if (is_anywhere) {
        row.anywhere_ms = rendering.timing().cpu_ms;
        row.anywhere = error.error();
    } else {
        row.encode_ms = encoding.timing().cpu_ms;
        row.render_ms = rendering.timing().cpu_ms;
        row.error = error.error();
    }
}

}  // namespace

std::vector<ActivityRow> measure_activity(const std::string& name, const Model& model,
                                          const std::vector<SceneWindow>& windows,
                                          const StageSettings& settings,
                                          const std::vector<double>& moving) {
    std::vector<VoxelGrid> dense = grids_of(windows, 1, model.config.bins, settings);
    std::vector<ActivityRow> rows;
    for (const double share : moving) {
        std::vector<VoxelGrid> grids = grids_of(windows, share, model.config.bins, settings);
        ActivityRow& row = rows.emplace_back();
        row.model = name;
        row.width = settings.width;
        row.height = settings.height;
        row.moving = share;
        for (const bool is_anywhere : {false, true})
            measure_frames(model, settings, dense, grids, is_anywhere, row);
    }
    return rows;
}

}  // namespace eventide::bench
