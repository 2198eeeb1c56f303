// A network's cost on this processor.
#include "apps/cli/run/quality/measure_profile.h"

#include "apps/bench/timing.h"
#include "apps/cli/settings/words.h"
#include "apps/cli/version.h"
#include "src/binning/binner.h"
#include "src/core/error.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"
#include "src/nn/backend.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace eventide::app {

namespace {

using Clock = std::chrono::steady_clock;

constexpr SensorDuration kWindow{50'000};
/// A clock of coarse steps shows nothing of a network that is all but free.
constexpr double kLeastMs = 1e-4;

/// An event at every second pixel, on and off, over the whole window.
std::vector<Event> scattered_events(int width, int height) {
    std::vector<Event> events;
    const int count = width * height / 2;
    events.reserve(std::size_t(count));
    for (int i = 0; i < count; ++i) {
        // Steps through all pixels in an order that has no pattern of its own.
        const auto pixel =
            std::uint64_t(i) * 2'654'435'761U % (std::uint64_t(width) * std::uint64_t(height));
        Event event{};
        event.t = SensorTime{} + SensorDuration{1 + i * (kWindow.count() - 1) / count};
        event.x = std::uint16_t(pixel % std::uint64_t(width));
        event.y = std::uint16_t(pixel / std::uint64_t(width));
        event.polarity = i % 2 == 0 ? Polarity::on : Polarity::off;
        events.push_back(event);
    }
    return events;
}

/// Runs stages one after the other until their share of the time is used.
class Measuring {
public:
    Measuring(const MeasureSettings& settings, int stages)
        : settings_{settings}, slice_{settings.time / stages} {}

    /// The least of the repetitions, ms: whatever else the machine does only adds.
    template <typename Body>
    double least(Body body) const {
        constexpr int kMax = 12;
        const auto begun = Clock::now();
        body();
        bench::Stopwatch watch;
        for (int i = 0; i < kMax && (i == 0 || Clock::now() - begun < slice_); ++i) {
            if (settings_.give_up && settings_.give_up())
                throw Error(ErrorKind::failed,
                            "stopped while it measured what this processor does");
            watch.start();
            body();
            watch.stop();
        }
        return std::max(kLeastMs, *std::ranges::min_element(watch.cpu_ms()));
    }

private:
    const MeasureSettings& settings_;
    std::chrono::duration<double> slice_;
};

/// Frames of one event window after the other.
class Frames {
public:
    Frames(Renderer& renderer, LatentMap& latent, const ProfileKey& key)
        : renderer_{renderer}, latent_{latent}, key_{key} {}

    void scale(double factor) {
        request_.width = std::max(1, int(std::lround(key_.width * factor)));
        request_.height = std::max(1, int(std::lround(key_.height * factor)));
        frame_ = renderer_.make_output(request_);
    }
    void fresh() {
        latent_.window = {end_, end_ + kWindow};
        end_ += kWindow;
        renderer_.push(latent_);
        place_ = 400;
        render();
    }
    void another() {
        place_ += 10;
        render();
    }

private:
    void render() {
        request_.t = end_ - kWindow + kWindow * place_ / 1000;
        renderer_.render(request_, frame_);
    }
    Renderer& renderer_;
    LatentMap& latent_;
    const ProfileKey& key_;
    RenderRequest request_;
    Frame frame_;
    SensorTime end_{};
    int place_ = 400;  // thousandths of the event window
};

void measure_frames(Frames frames, const Measuring& measuring, PrecisionCost& cost) {
    const auto another_at = [&](double scale) {
        frames.scale(scale);
        frames.fresh();
        return measuring.least([&] { frames.another(); });
    };
    cost.full_ms = another_at(1);
    const double fresh = measuring.least([&] { frames.fresh(); });
    cost.first_ms = std::max(kLeastMs, fresh - cost.full_ms);
    cost.half_ms = another_at(0.5);
    cost.third_ms = another_at(1.0 / 3);
}

PrecisionCost measure_precision(const ProfileKey& key, const Model& model, Precision precision,
                                const EngineOptions& options, const VoxelGrid& grid,
                                const Measuring& measuring) {
    PrecisionCost cost;
    cost.precision = precision;
    LatentMap latent;
    {
        Encoder encoder{model, key.width, key.height, options};
        cost.engine = encoder.description();
        latent = encoder.make_output();
        cost.encode_ms = measuring.least([&] { encoder.encode(grid, latent); });
    }
    latent.history = {};  // the same map again and again: no history is true of it
    Renderer renderer{model, key.width, key.height, options};
    measure_frames({renderer, latent, key}, measuring, cost);
    return cost;
}

}  // namespace

ProfileKey profile_key(const std::string& name, const Model& model, int width, int height,
                       Kernels kernels) {
    std::string instructions = name_of(Backend{});
    if (const Bf16Kernels* bf16 = bf16_kernels())
        instructions += ", " + name_of(Backend{.bf16 = bf16});
    return {processor_text(),
            instructions,
            show_word(kernels, kKernelWords),
            version(),
            name,
            model_identity(model),
            width,
            height};
}

QualityProfile measure_profile(const ProfileKey& key, const Model& model,
                               const MeasureSettings& settings) {
    const std::vector<Event> events = scattered_events(key.width, key.height);
    Binner binner{model.config.bins, key.height, key.width};
    VoxelGrid grid = binner.make_output();
    binner.process({.window = {SensorTime{}, SensorTime{} + kWindow}, .events = events}, grid);

    std::vector<Precision> precisions{Precision::f32};
    if (bf16_kernels() != nullptr) precisions.push_back(Precision::bf16);
    constexpr int kStages = 5;
    const Measuring measuring{settings, kStages * int(precisions.size())};
    QualityProfile profile{key, {}};
    for (const Precision precision : precisions) {
        EngineOptions options;
        options.precision = precision;
        options.kernels = settings.kernels;
        options.skip_quiet = false;
        profile.costs.push_back(measure_precision(key, model, precision, options, grid, measuring));
    }
    return profile;
}

}  // namespace eventide::app
