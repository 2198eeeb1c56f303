// Hours of stream time at full speed.
#include "apps/cli/stress/soak.h"

#include "apps/cli/stress/process_size.h"
#include "apps/cli/stress/worst.h"
#include "pipeline/model_render_stage.h"
#include "pipeline/pace/latency.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

namespace eventide::stress {
namespace {

constexpr SensorDuration kSecond{1'000'000};
constexpr int kParts = 100;

/// Of ten minutes six are motion, three a pause, and in one there are bursts: all pixels twenty
/// times within ten milliseconds, once a second.
class PausesAndBursts {
public:
    PausesAndBursts(int width, int height, SensorTime end)
        : width_{width}, height_{height}, end_{end} {}

    void operator()(std::vector<Event>& into) {
        while (into.empty() && now_ < end_) {
            const auto minute = to_us(now_) / 60'000'000 % 10;
            if (minute < 6 || minute == 9)
                into =
                    moving_edge(width_, height_, now_, now_ + kSecond, std::uint64_t(to_us(now_)));
            if (minute == 9) burst(into);
            now_ += kSecond;
        }
    }

private:
    void burst(std::vector<Event>& into) const {
        for (int n = 0; n < 20; ++n)
            for (int p = 0; p < width_ * height_; ++p)
                into.push_back({now_ + kSecond - SensorDuration{500 * (20 - n)},
                                std::uint16_t(p % width_), std::uint16_t(p / width_),
                                (p + n) % 2 == 0 ? Polarity::on : Polarity::off});
        std::ranges::stable_sort(into, {}, &Event::t);
    }

    int width_, height_;
    SensorTime now_{}, end_;
};

struct StateSize {
    double largest = 0, rms = 0;
};

StateSize size_of(const TensorFile& state, const ModelConfig& config) {
    StateSize size;
    double squares = 0, count = 0;
    for (std::size_t l = 0; l < config.recurrent.size(); ++l) {
        const auto found = state.tensors.find("h." + std::to_string(l));
        if (found == state.tensors.end() || config.recurrent[l] == 0) continue;
        for (const float h : found->second.values) {
            size.largest = worst_of(size.largest, std::abs(double(h)));
            squares += double(h) * h;
            ++count;
        }
    }
    size.rms = count == 0 ? 0 : std::sqrt(squares / count);
    return size;
}

/// Looks at the state where somebody has asked.
class WatchedStates final : public EncodeStage {
public:
    WatchedStates(Encoder& encoder, const ModelConfig& config)
        : encoder_{encoder}, config_{config} {}
    LatentMap make_output() const override { return encoder_.make_output(); }
    void reset() noexcept override { encoder_.reset(); }
    /// Of the window at which it was asked last; asks again. Thread: any.
    StateSize ask() {
        asked_ = true;
        const std::lock_guard lock{mutex_};
        return size_;
    }

private:
    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override {
        encoder_.encode(grid, latent);
        if (!asked_.exchange(false)) return;
        const StateSize size = size_of(encoder_.state(), config_);
        const std::lock_guard lock{mutex_};
        size_ = size;
    }

    Encoder& encoder_;
    const ModelConfig& config_;
    std::atomic<bool> asked_{true};
    std::mutex mutex_;
    StateSize size_;
};

double milliseconds(std::chrono::nanoseconds duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

/// Takes a sample at the end of each part.
class Sampler final : public Sink {
public:
    Sampler(const SoakSettings& settings, WatchedStates& states)
        : settings_{settings}, states_{states} {}
    void follow(const Pipeline& pipeline) { pipeline_ = &pipeline; }

    void write(const Frame& frame) override {
        latency_->record(std::chrono::steady_clock::now() - frame.arrived);
        const double hours = double(to_us(frame.t)) / 3.6e9;
        if (hours < settings_.hours * double(samples_.size() + 1) / kParts) return;
        const Snapshot counters = pipeline_->snapshot();
        const LatencySummary latency = latency_->summary();
        const StateSize state = states_.ask();
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun_;
        samples_.push_back({hours, taken.count(), counters.events, counters.encoded,
                            double(process_size().resident) / (1 << 20), milliseconds(latency.p50),
                            milliseconds(latency.p99), state.largest, state.rms});
        latency_ = std::make_unique<LatencyHistogram>();
        if (settings_.on_sample) settings_.on_sample(samples_.back());
    }
    bool wants_more() const override { return !settings_.stopping || !settings_.stopping(); }
    std::vector<SoakSample> take() { return std::move(samples_); }

private:
    const SoakSettings& settings_;
    WatchedStates& states_;
    const Pipeline* pipeline_ = nullptr;
    std::unique_ptr<LatencyHistogram> latency_ = std::make_unique<LatencyHistogram>();
    std::vector<SoakSample> samples_;
    const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace

std::vector<SoakSample> soak(const Model& model, const EngineOptions& engine,
                             const SoakSettings& settings) {
    const SensorTime end{SensorDuration{std::int64_t(settings.hours * 3.6e9)}};
    MadeStream source{settings.width, settings.height,
                      PausesAndBursts{settings.width, settings.height, end + kSecond}};
    Encoder encoder{model, settings.width, settings.height, engine};
    Renderer renderer{model, settings.width, settings.height, engine};
    WatchedStates states{encoder, model.config};
    ModelRenderStage render{renderer, {}};
    Sampler sampler{settings, states};
    PipelineSettings how;
    how.bins = model.config.bins;
    how.rate = {10, 1};
    Pipeline pipeline{{source, states, render, {&sampler}}, how};
    sampler.follow(pipeline);
    pipeline.run();
    return sampler.take();
}

namespace {

double median_p99(std::vector<SoakSample> samples) {
    const auto middle = samples.begin() + std::ptrdiff_t(samples.size() / 2);
    std::ranges::nth_element(samples, middle, {}, &SoakSample::latency_p99_ms);
    return middle->latency_p99_ms;
}

}  // namespace

Result soak_verdict(const std::vector<SoakSample>& samples) {
    Result result;
    if (samples.size() < 8) {
        result.happened = std::to_string(samples.size()) + " samples";
        result.expect(false, "at least 8");
        return result;
    }
    // A run of less than two minutes has no minute to wait for: its first quarter, then.
    const bool is_long = samples.back().host_seconds > 120;
    const auto steady =
        is_long ? std::ranges::find_if(
                      samples, [](const SoakSample& sample) { return sample.host_seconds >= 60; })
                : samples.begin() + std::ptrdiff_t(samples.size() / 4);
    double off = 0, largest = 0;
    for (auto at = steady; at != samples.end(); ++at)
        off = std::max(off, std::abs(at->resident_mib / steady->resident_mib - 1));
    for (const SoakSample& sample : samples) largest = worst_of(largest, sample.largest_state);
    const auto quarter = std::ptrdiff_t(samples.size() / 4);
    const double early = median_p99({samples.begin(), samples.begin() + quarter});
    const double late = median_p99({samples.end() - quarter, samples.end()});
    result.happened = short_number(samples.back().stream_hours) + " h of stream time in " +
                      short_number(samples.back().host_seconds) + " s, " +
                      counted(samples.back().windows, "windows, ") +
                      counted(samples.back().events, "events; ") + "resident memory " +
                      short_number(steady->resident_mib) + " MiB within " +
                      short_number(100 * off) + " %, latency p99 " + short_number(early) +
                      " ms in the first quarter, " + short_number(late) +
                      " in the last, states within " + short_number(largest);
    result.error = off;
    result.bound = .01;
    result.expect(off <= .01, "memory flat");
    result.expect(late <= 2 * early, "latency flat");
    result.expect(largest <= 1, "states within 1");
    return result;
}

}  // namespace eventide::stress
