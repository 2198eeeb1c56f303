/// @file
/// Event cameras in software before made scenes: events with the truth they came from, and how far
/// a frame is from the truth.
#pragma once

#include <eventide/array.h>
#include <eventide/event.h>
#include <eventide/version.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

/// What is simulated. A scene and a sensor are drawn from the preset's ranges.
struct SimulationOptions {
    std::string scene = "demo";     ///< a name in EventSimulation::scenes()
    std::uint64_t seed = 0;         ///< another seed, another scene; 0: the preset's own
    int width = 240;                ///< px, of the sensor, 2 to 8192
    int height = 180;               ///< px, of the sensor, 2 to 8192
    double seconds = 4;             ///< length of sensor time, up to 1e9; 0: without end
    double images_per_second = 0;   ///< the camera's, in Batch::images; up to 1e5, 0: none
    double truths_per_second = 25;  ///< up to 1e5; 0: none
    /// Above 0, up to 64: truth has (width - 1) scale + 1 columns, so that corners stay corners.
    double truth_scale = 1;
    /// Folder of images that things look like, or a pack of them (eventide-pack-images); empty:
    /// made-up ones.
    std::filesystem::path textures{};
};

/// What an ideal camera would show at one instant: [y][x], 0 black to 1 white.
struct TrueImage {
    SensorTime t{};           ///< that instant
    Array2<float> intensity;  ///< [y][x], 0 black to 1 white
};

/// The same options give the same data, bit for bit. Thread: one at a time; several simulations may
/// run beside each other.
class EVENTIDE_API EventSimulation {
public:
    /// Throws Error: usage for an unknown scene and for numbers out of range, input for textures
    /// that cannot be read.
    explicit EventSimulation(const SimulationOptions& options = {});
    ~EventSimulation();
    EventSimulation(EventSimulation&&) noexcept;             ///< leaves the other empty
    EventSimulation& operator=(EventSimulation&&) noexcept;  ///< leaves the other empty

    const SensorInfo& info() const noexcept;  ///< the serial is the seed
    int width() const noexcept;               ///< px
    int height() const noexcept;              ///< px

    /// The next 10 ms at most, in place of what `batch` and `truths` held: events in order of time,
    /// and the truths of the instants until the last of them. False at the end.
    bool read(Batch& batch, std::vector<TrueImage>& truths);

    /// Everything before this time has been read; zero before the first read().
    SensorTime clock() const noexcept;

    /// Names of the presets.
    static std::vector<std::string> scenes();

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// LPIPS v0.1 (Zhang et al. 2018): how different two images look to a network that was trained to
/// name what images show. Const functions: any thread, also at once.
class EVENTIDE_API PerceptualDistance {
public:
    /// An npz file with the weights of SqueezeNet 1.1 or AlexNet, their linear heads and the
    /// scaling of colours, by the names "core.net.slice1.0.weight", "core.lins.0.model.1.weight",
    /// "core.scaling_layer.shift" and so on; none is installed. Throws Error (input).
    explicit PerceptualDistance(const std::filesystem::path& weights);
    ~PerceptualDistance();
    PerceptualDistance(PerceptualDistance&&) noexcept;             ///< leaves the other empty
    PerceptualDistance& operator=(PerceptualDistance&&) noexcept;  ///< leaves the other empty

    /// "LPIPS-Squeeze" or "LPIPS-Alex": the two give different numbers.
    std::string name() const;

    /// 0 for equal images; about .1 similar, .7 unlike. [y][x], 0 black to 1 white, finite, of one
    /// size, at least 17 px each way (Squeeze) or 31 px (Alex). Throws Error (usage) else.
    double between(const Array2<float>& a, const Array2<float>& b) const;

private:
    class Impl;
    std::unique_ptr<const Impl> impl_;
};

/// Measures of one frame, in which all pixels count alike: the numbers that `eventide evaluate`
/// prints.
struct FrameMeasures {
    double mse = 0;   ///< mean of (intensity - truth)^2
    double ssim = 0;  ///< structural similarity (Wang et al. 2004), Gaussian window of 11 px
    double affine_mse =
        0;  ///< both again after the gain and offset that bring the frame nearest to
    double affine_ssim = 0;  ///< the truth: what is left when brightness is forgiven

    // Empty where there is no sigma.
    std::optional<double>
        picp80;  ///< share of pixels within 1.2816 sigma of the truth; .8 is right
    std::optional<double> log_likelihood;  ///< mean, nats per pixel, of a Gaussian of this sigma;
                                           ///< infinite where a pixel's sigma is 0

    std::optional<double> lpips;  ///< empty where no PerceptualDistance was given
};

/// `intensity` is clipped to 0..1 first; `sigma` may be empty and is nowhere below 0, `lpips` may
/// be null. [y][x], 0 black to 1 white, finite, of one size, at least 11 px each way, and what
/// `lpips` wants. Throws Error (usage) else.
EVENTIDE_API FrameMeasures measure(const Array2<float>& intensity, const Array2<float>& sigma,
                                   const Array2<float>& truth,
                                   const PerceptualDistance* lpips = nullptr);

}  // namespace eventide
