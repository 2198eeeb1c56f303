// What is known about one reconstructed image, one sequence, and a whole evaluation.
#pragma once

#include "src/core/array.h"
#include "src/metrics/lpips.h"
#include "src/metrics/uncertainty.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

struct ImageScores {
    double mse = 0, ssim = 0;
    std::optional<double> lpips;  ///< where a network was given
};

/// One image against its truth. Intensity is clipped to [0, 1] before it is judged.
struct FrameScores {
    double time_s = 0;            ///< from the beginning of the sequence
    double events_per_pixel = 0;  ///< of the event window
    ImageScores raw;
    ImageScores affine;  ///< after the gain and offset that bring it nearest to the truth
    std::optional<double> correlation;             ///< with the truth; nothing where either is flat
    std::optional<double> mean_sigma, picp80, ll;  ///< where there is a sigma
    std::optional<double> lpips_corr;              ///< where there are sigma and LPIPS
};

/// Means over frames.
struct SequenceScores {
    std::string sequence;
    int frames = 0;
    ImageScores raw, affine;
    std::optional<double> correlation, mean_sigma, picp80, ll, lpips_corr;
};

/// Sums over all pixels and patches, for figures and for calibration.
struct Observations {
    /// Square errors by sigma, in bins of equal ratio from .005 to 1.
    struct SigmaBin {
        double sigma = 0, squared_error = 0;  ///< sums
        std::uint64_t pixels = 0;
    };
    static constexpr int kSigmaBins = 24;
    /// LPIPS of patches by their median sigma, in the same bins.
    struct PatchBin {
        double sigma = 0, lpips = 0;  ///< sums; sigma: of the medians
        std::uint64_t patches = 0;
    };
    struct PatchSize {
        int size = 0;                 ///< px
        double sum = 0, squares = 0;  ///< of the correlation over the patches of one frame
        int frames = 0;
    };

    std::array<SigmaBin, kSigmaBins> sigma_bins{};
    std::array<PatchBin, kSigmaBins> patch_bins{};
    std::vector<PatchSize> patch_sizes;  ///< 8, 12 ... 96 px
    Reliability reliability;
    SigmaScale sigma_scale;

    Observations& operator+=(const Observations& other);
};

/// Judges images one by one. With `lpips` null, LPIPS is left out. One thread at a time.
class Judge {
public:
    explicit Judge(const Lpips* lpips) : lpips_(lpips) {}

    /// `sigma` may be empty. All of one size, at least 11 x 11 px. Throws Error(usage).
    FrameScores judge(const Array2<float>& intensity, const Array2<float>& sigma,
                      const Array2<float>& truth);

    const Observations& observations() const { return observations_; }

private:
    void observe(const Array2<float>& mu, const Array2<float>& sigma, const Array2<float>& truth);
    std::optional<double> observe_patches(const Array2<float>& lpips_map,
                                          const Array2<float>& sigma);

    const Lpips* lpips_;
    Observations observations_;
};

/// The same; an Error names what was judged.
FrameScores judged(const std::string& name, Judge& judge, const Array2<float>& intensity,
                   const Array2<float>& sigma, const Array2<float>& truth);

/// Means over frames; a score that only some frames have is the mean over those.
SequenceScores mean_scores(const std::string& sequence, const std::vector<FrameScores>& frames);

}  // namespace eventide
