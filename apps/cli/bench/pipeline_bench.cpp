// The whole pipeline on a recording in memory.
#include "apps/cli/bench/pipeline_bench.h"

#include "apps/cli/run/loaded_model.h"
#include "apps/cli/run/reference_images.h"
#include "pipeline/filters/event_filter.h"
#include "pipeline/model_render_stage.h"
#include "pipeline/pipeline.h"
#include "replay/real_time_playback.h"
#include "src/binning/slicer_settings.h"
#include "src/metrics/image_measures.h"

#include <chrono>

namespace eventide::app {

namespace {

using Clock = std::chrono::steady_clock;

/// Compares each frame with the image of its time. Render thread.
class ErrorSink : public Sink {
public:
    ErrorSink(const ReferenceImages& references, const Size& sensor, const Lpips* lpips)
        : references_{references}, sensor_{sensor}, judge_{lpips}, thorough_{lpips != nullptr} {}

    void write(const Frame& frame) override {
        cv::Mat image;
        references_.draw(frame.t, frame.window, {sensor_.width, sensor_.height}, image);
        if (image.empty() || frame.intensity.width() != image.cols ||
            frame.intensity.height() != image.rows)
            return;
        Array2<float> truth(image.rows, image.cols);
        for (int y = 0; y < image.rows; ++y) {
            const auto* row = image.ptr<std::uint8_t>(y);
            for (int x = 0; x < image.cols; ++x) truth(y, x) = float(row[x]) / 255;
        }
        // Means of squares are quick; the rest would slow down what is measured.
        FrameScores scores;
        if (thorough_)
            scores = judge_.judge(frame.intensity, frame.sigma, truth);
        else
            scores.raw.mse = mean_squared_error(clipped(frame.intensity), truth);
        scores_.push_back(scores);
    }
    SequenceScores error() const { return mean_scores({}, scores_); }

private:
    const ReferenceImages& references_;
    Size sensor_;
    Judge judge_;
    bool thorough_;
    std::vector<FrameScores> scores_;
};

std::unique_ptr<Recording> playback(const std::shared_ptr<const RecordedPackets>& data,
                                    double speed) {
    auto recording = std::make_unique<MemoryRecording>(data);
    if (speed == 0) return recording;
    return std::make_unique<RealTimePlayback>(std::move(recording), speed);
}

}  // namespace

double milliseconds(std::chrono::nanoseconds duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

PipelineBench measure_pipeline(const std::shared_ptr<const RecordedPackets>& data,
                               const PipelineBenchSettings& settings, Signals& signals) {
    RunSettings of_network;
    of_network.model = settings.model;
    of_network.precision = settings.precision;
    of_network.kernels = settings.kernels;
    of_network.instructions = settings.instructions;
    of_network.engine = settings.engine;
    of_network.threads = settings.threads;
    of_network.size.scale = settings.scale;
    Network network{of_network, data->info};
    const Size sensor{data->info.width, data->info.height};
    const Size size = of_network.size.of(sensor);
    RenderRequest request;
    request.width = size.width;
    request.height = size.height;
    request.lookahead = settings.lookahead;
    ModelRenderStage render{network.renderer(), request};
    ReferenceImages references;
    ErrorSink sink{references, sensor, settings.lpips};
    PipelineSettings how;
    how.bins = network.config().bins;
    how.event_windows.slicer = parse_window(settings.window);
    how.rate = settings.rate;
    how.lookahead = settings.lookahead;
    const auto filter =
        event_filter({"off", "model"}, network.config(), sensor.width, sensor.height);
    const std::unique_ptr<Recording> recording = playback(data, settings.speed);
    Pipeline pipeline{{*recording, network.encoder(), render, {&sink}, filter.get(), &references},
                      how};
    const Stopper stopper{signals, [&] { pipeline.stop(); }};
    const auto begun = Clock::now();
    pipeline.run();
    return {network.file().stem().string(),
            network.encoder().description(),
            sensor,
            pipeline.snapshot(),
            std::chrono::duration<double>(Clock::now() - begun).count(),
            sink.error()};
}

}  // namespace eventide::app
