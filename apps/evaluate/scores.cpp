// Judging an image: raw, fitted, and its sigma.
#include "apps/evaluate/scores.h"

#include "src/core/error.h"
#include "src/metrics/image_measures.h"

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

constexpr int kCorrelationPatch = 16;  // px, the thesis' choice for LPIPS_CORR
constexpr double kLowestSigma = .005;

std::size_t sigma_bin(double sigma) {
    const double share = std::log(sigma / kLowestSigma) / std::log(1 / kLowestSigma);
    return std::size_t(
        std::clamp(share * Observations::kSigmaBins, 0., Observations::kSigmaBins - 1.));
}

ImageScores scored(const Array2<float>& image, const Array2<float>& truth, const Lpips* lpips,
                   const Lpips::Features& image_features, const Lpips::Features& truth_features) {
    ImageScores out{mean_squared_error(image, truth), structural_similarity(image, truth),
                    std::nullopt};
    if (lpips) out.lpips = lpips->distance(image_features, truth_features);
    return out;
}

double mean(const Array2<float>& map) {
    double sum = 0;
    for (const float v : map.values()) sum += double(v);
    return sum / double(map.values().size());
}

/// The mean of what `score` gives, over the frames where it gives something.
template <typename Score>
std::optional<double> mean_of(const std::vector<FrameScores>& frames, Score score) {
    double sum = 0;
    int n = 0;
    for (const FrameScores& frame : frames)
        if (const std::optional<double> value = score(frame)) {
            sum += *value;
            ++n;
        }
    if (n == 0) return std::nullopt;
    return sum / n;
}

template <typename Image>
ImageScores mean_images(const std::vector<FrameScores>& frames, Image image) {
    const auto over = [&](auto field) {
        return mean_of(
            frames, [&](const FrameScores& f) -> std::optional<double> { return image(f).*field; });
    };
    return {over(&ImageScores::mse).value_or(NAN), over(&ImageScores::ssim).value_or(NAN),
            over(&ImageScores::lpips)};
}

}  // namespace

Observations& Observations::operator+=(const Observations& other) {
    for (std::size_t i = 0; i < kSigmaBins; ++i) {
        sigma_bins[i].sigma += other.sigma_bins[i].sigma;
        sigma_bins[i].squared_error += other.sigma_bins[i].squared_error;
        sigma_bins[i].pixels += other.sigma_bins[i].pixels;
        patch_bins[i].sigma += other.patch_bins[i].sigma;
        patch_bins[i].lpips += other.patch_bins[i].lpips;
        patch_bins[i].patches += other.patch_bins[i].patches;
    }
    if (patch_sizes.empty()) {
        patch_sizes = other.patch_sizes;
    } else {
        for (std::size_t i = 0; i < other.patch_sizes.size(); ++i) {
            patch_sizes[i].sum += other.patch_sizes[i].sum;
            patch_sizes[i].squares += other.patch_sizes[i].squares;
            patch_sizes[i].frames += other.patch_sizes[i].frames;
        }
    }
    reliability += other.reliability;
    sigma_scale += other.sigma_scale;
    return *this;
}

FrameScores Judge::judge(const Array2<float>& intensity, const Array2<float>& sigma,
                         const Array2<float>& truth) {
    const Array2<float> mu = clipped(intensity);
    const Spread both = spread(mu, truth);
    const Array2<float> fitted = clipped(applied(affine_fit(both), mu));
    Lpips::Features seen_truth, seen_mu, seen_fitted;
    if (lpips_) {
        seen_truth = lpips_->features(truth);
        seen_mu = lpips_->features(mu);
        seen_fitted = lpips_->features(fitted);
    }
    FrameScores out;
    out.raw = scored(mu, truth, lpips_, seen_mu, seen_truth);
    out.affine = scored(fitted, truth, lpips_, seen_fitted, seen_truth);
    out.correlation = correlation(both);
    if (sigma.empty()) return out;
    out.mean_sigma = mean(sigma);
    out.picp80 = coverage_80(mu, sigma, truth);
    out.ll = log_likelihood(mu, sigma, truth);
    observe(mu, sigma, truth);
    if (lpips_) out.lpips_corr = observe_patches(lpips_->distance_map(seen_mu, seen_truth), sigma);
    return out;
}

void Judge::observe(const Array2<float>& mu, const Array2<float>& sigma,
                    const Array2<float>& truth) {
    observations_.reliability.add(mu, sigma, truth);
    observations_.sigma_scale.add(mu, sigma, truth);
    for (std::size_t i = 0; i < mu.values().size(); ++i) {
        const double error = double(mu.values()[i]) - double(truth.values()[i]);
        const double s = double(sigma.values()[i]);
        Observations::SigmaBin& bin = observations_.sigma_bins[sigma_bin(s)];
        bin.sigma += s;
        bin.squared_error += error * error;
        ++bin.pixels;
    }
}

std::optional<double> Judge::observe_patches(const Array2<float>& lpips_map,
                                             const Array2<float>& sigma) {
    std::vector<Observations::PatchSize>& sizes = observations_.patch_sizes;
    if (sizes.empty())
        for (int size = 8; size <= 96; size += 4) sizes.push_back({size, 0, 0, 0});
    std::optional<double> chosen;
    for (Observations::PatchSize& at : sizes) {
        const std::vector<double> error = patch_means(lpips_map, at.size);
        const std::vector<double> doubt = patch_medians(sigma, at.size);
        const std::optional<double> r = correlation(spread(error, doubt));
        if (at.size == kCorrelationPatch) {
            chosen = r;
            for (std::size_t i = 0; i < error.size(); ++i) {
                Observations::PatchBin& bin = observations_.patch_bins[sigma_bin(doubt[i])];
                bin.sigma += doubt[i];
                bin.lpips += error[i];
                ++bin.patches;
            }
        }
        if (!r) continue;
        at.sum += *r;
        at.squares += *r * *r;
        ++at.frames;
    }
    return chosen;
}

FrameScores judged(const std::string& name, Judge& judge, const Array2<float>& intensity,
                   const Array2<float>& sigma, const Array2<float>& truth) {
    try {
        return judge.judge(intensity, sigma, truth);
    } catch (const Error& error) {
        throw Error(error.kind(), name + ": " + error.what());
    }
}

SequenceScores mean_scores(const std::string& sequence, const std::vector<FrameScores>& frames) {
    return {.sequence = sequence,
            .frames = int(frames.size()),
            .raw = mean_images(frames, [](const FrameScores& f) { return f.raw; }),
            .affine = mean_images(frames, [](const FrameScores& f) { return f.affine; }),
            .correlation = mean_of(frames, [](const FrameScores& f) { return f.correlation; }),
            .mean_sigma = mean_of(frames, [](const FrameScores& f) { return f.mean_sigma; }),
            .picp80 = mean_of(frames, [](const FrameScores& f) { return f.picp80; }),
            .ll = mean_of(frames, [](const FrameScores& f) { return f.ll; }),
            .lpips_corr = mean_of(frames, [](const FrameScores& f) { return f.lpips_corr; })};
}

}  // namespace eventide
