// Images of other sizes than the sensor's, against images of its size enlarged.
#include "apps/evaluate/figure_sequences.h"

#include <opencv2/imgproc.hpp>

#include <cmath>

namespace eventide {
namespace {

/// Cubic convolution with corners aligned, as the renderer's sizes are.
Array2<float> enlarged(const Array2<float>& image, int width, int height) {
    const cv::Mat from(image.height(), image.width(), CV_32F,
                       const_cast<float*>(image.values().data()));
    Array2<float> out(height, width);
    cv::Mat to(height, width, CV_32F, out.values().data());
    const double sx = double(image.width() - 1) / (width - 1);
    const double sy = double(image.height() - 1) / (height - 1);
    const cv::Mat back = (cv::Mat_<double>(2, 3) << sx, 0, 0, 0, sy, 0);
    cv::warpAffine(from, to, back, to.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    return out;
}

}  // namespace

std::vector<Plot> spatial_super_resolution(const FigureSettings& what,
                                           const EvaluateSettings& how) {
    const FigureSequences sequences{"spatial", what, how};
    const int width = sequences.width(), height = sequences.height();
    const FigureScores scores = sequences.run_each([&](int i, FigureScores& found) {
        Judge judge = sequences.make_judge();
        Array2<float> at_sensor_size;
        ModelRun run = sequences.make_run([&](const Query& query, const Frame& frame) {
            const double scale = std::round(2. * query.width / width) / 2;
            if (query.width == width) at_sensor_size = frame.intensity;
            found[{"model", scale}].push_back(
                judge.judge(frame.intensity, frame.sigma, query.truth));
            found[{"cubic", scale}].push_back(
                judge.judge(enlarged(at_sensor_size, query.width, query.height), {}, query.truth));
        });
        int k = 0;
        sequences.push_windows(
            i, run, [&](const EventWindow& event_window, const SimulatedStream& stream) {
                if (!is_scored(what.simulated, k++)) return;
                const SensorTime end = event_window.window.end;
                run.ask(truth_query(stream, end, width, height));
                for (const double scale : what.scales)
                    if (scale > 1)
                        run.ask(truth_query(stream, end, int(std::lround(scale * width)),
                                            int(std::lround(scale * height))));
            });
        run.finish();
    });
    return sequences.plots_of(scores,
                              {"spatial", "spatial super-resolution", "size over the sensor's"});
}

}  // namespace eventide
