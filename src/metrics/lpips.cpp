// The two backbones, and the distance between what they see.
#include "src/metrics/lpips.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/metrics/convolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace eventide {

struct Lpips::Network {
    /// One layer whose output is compared; layers follow each other.
    using Layer = std::function<FeatureMap(const FeatureMap&)>;
    std::vector<Layer> layers;
    std::vector<std::vector<float>> heads;  ///< [layer][channel], the linear heads
    std::array<float, 3> shift{}, scale{};
    int smallest = 0;  ///< px, least height and width
};

namespace {

constexpr float kNormFloor = 1e-10F;  // as the authors' normalize_tensor

FeatureMap convolved(const Convolution& convolution, const FeatureMap& in) {
    FeatureMap out(convolution.output_size(in.height()), convolution.output_size(in.width()),
                   convolution.out_channels());
    convolution.process(in, out);
    return out;
}

/// torchvision's squeezenet1_1.features cut where LPIPS cuts it: after layers 1, 4, 7, 9 to 12.
template <typename Network>
void add_squeeze(const NpzFile& file, Network& network) {
    const auto add_fire = [&](const std::string& name, int in, int squeezed, int expanded) {
        network.layers.push_back([fire = Fire(file, "core.net." + name, in, squeezed, expanded)](
                                     const FeatureMap& map) { return fire.process(map); });
        return 2 * expanded;
    };
    network.layers.push_back([c = Convolution(file, "core.net.slice1.0",
                                              {.in = 3, .out = 64, .kernel = 3, .stride = 2})](
                                 const FeatureMap& map) { return convolved(c, map); });
    const auto add_pooled_fires = [&](const std::string& a, const std::string& b, int in,
                                      int squeezed, int expanded) {
        network.layers.push_back([first = Fire(file, "core.net." + a, in, squeezed, expanded),
                                  second = Fire(file, "core.net." + b, 2 * expanded, squeezed,
                                                expanded)](const FeatureMap& map) {
            return second.process(first.process(max_pool(map, true)));
        });
    };
    add_pooled_fires("slice2.3", "slice2.4", 64, 16, 64);
    add_pooled_fires("slice3.6", "slice3.7", 128, 32, 128);
    network.layers.push_back(
        [fire = Fire(file, "core.net.slice4.9", 256, 48, 192)](const FeatureMap& map) {
            return fire.process(max_pool(map, true));
        });
    int channels = 2 * 192;
    channels = add_fire("slice5.10", channels, 48, 192);
    channels = add_fire("slice6.11", channels, 64, 256);
    add_fire("slice7.12", channels, 64, 256);
    network.smallest = 17;
}

/// torchvision's alexnet.features, cut after each of its five convolutions.
template <typename Network>
void add_alex(const NpzFile& file, Network& network) {
    const auto add = [&](const std::string& name, const ConvolutionShape& shape, bool pooled) {
        network.layers.push_back(
            [c = Convolution(file, "core.net." + name, shape), pooled](const FeatureMap& map) {
                return pooled ? convolved(c, max_pool(map, false)) : convolved(c, map);
            });
    };
    add("slice1.0", {.in = 3, .out = 64, .kernel = 11, .stride = 4, .padding = 2}, false);
    add("slice2.3", {.in = 64, .out = 192, .kernel = 5, .padding = 2}, true);
    add("slice3.6", {.in = 192, .out = 384, .kernel = 3, .padding = 1}, true);
    add("slice4.8", {.in = 384, .out = 256, .kernel = 3, .padding = 1}, false);
    add("slice5.10", {.in = 256, .out = 256, .kernel = 3, .padding = 1}, false);
    network.smallest = 31;
}

/// Divides each pixel's numbers by their Euclidean norm.
FeatureMap normalised(FeatureMap map) {
    const auto channels = std::size_t(map.channels());
    const auto values = map.values();
    for (std::size_t at = 0; at < values.size(); at += channels) {
        const auto pixel = values.subspan(at, channels);
        float sum = 0;
        for (const float v : pixel) sum += v * v;
        const float inverse = 1 / (std::sqrt(sum) + kNormFloor);
        for (float& v : pixel) v *= inverse;
    }
    return map;
}

/// Adds `map` at the size of `out`, bilinear, pixel centres aligned at half (torch's
/// align_corners=False).
void add_upsampled(const Array2<float>& map, Array2<float>& out) {
    struct Tap {
        int low, high;
        float share;
    };
    const auto tap = [](int i, int from, int to) {
        const double at = std::max(0., (i + .5) * from / to - .5);
        const int low = std::min(int(at), from - 1);
        return Tap{low, std::min(low + 1, from - 1), float(at - low)};
    };
    for (int y = 0; y < out.height(); ++y) {
        const Tap v = tap(y, map.height(), out.height());
        for (int x = 0; x < out.width(); ++x) {
            const Tap h = tap(x, map.width(), out.width());
            const float top = std::lerp(map(v.low, h.low), map(v.low, h.high), h.share);
            const float bottom = std::lerp(map(v.high, h.low), map(v.high, h.high), h.share);
            out(y, x) += std::lerp(top, bottom, v.share);
        }
    }
}

}  // namespace

Lpips::Lpips(const std::filesystem::path& weights) {
    const NpzFile file{weights};
    auto network = std::make_unique<Network>();
    const bool squeeze = file.contains("core.net.slice2.3.squeeze.weight");
    if (squeeze)
        add_squeeze(file, *network);
    else
        add_alex(file, *network);
    name_ = squeeze ? "LPIPS-Squeeze" : "LPIPS-Alex";
    const std::vector<std::int64_t> channels =
        squeeze ? std::vector<std::int64_t>{64, 128, 256, 384, 384, 512, 512}
                : std::vector<std::int64_t>{64, 192, 384, 256, 256};
    for (std::size_t i = 0; i < channels.size(); ++i)
        network->heads.push_back(weights_of(
            file, "core.lins." + std::to_string(i) + ".model.1.weight", {1, channels[i], 1, 1}));
    std::ranges::copy(weights_of(file, "core.scaling_layer.shift", {1, 3, 1, 1}),
                      network->shift.begin());
    std::ranges::copy(weights_of(file, "core.scaling_layer.scale", {1, 3, 1, 1}),
                      network->scale.begin());
    network_ = std::move(network);
}

Lpips::~Lpips() = default;

Lpips::Features Lpips::features(const Array2<float>& image) const {
    Array3<float> colour(image.height(), image.width(), 3);
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) std::ranges::fill(colour.pixel(y, x), image(y, x));
    return features(colour);
}

Lpips::Features Lpips::features(const Array3<float>& image) const {
    if (image.height() < network_->smallest || image.width() < network_->smallest ||
        image.channels() != 3)
        throw Error(ErrorKind::usage, name_ + ": expected 3 channels of at least " +
                                          std::to_string(network_->smallest) +
                                          " px each way, found " +
                                          std::to_string(image.channels()) + " of " +
                                          size_text(image.width(), image.height()));
    FeatureMap map = image;
    for (std::size_t i = 0; i < map.values().size(); ++i)
        map.values()[i] =
            (2 * map.values()[i] - 1 - network_->shift[i % 3]) / network_->scale[i % 3];
    Features features{image.height(), image.width(), {}};
    for (const Network::Layer& layer : network_->layers) {
        map = layer(map);
        features.layers.push_back(normalised(map));
    }
    return features;
}

Array2<float> Lpips::layer_differences(const Features& a, const Features& b,
                                       std::size_t layer) const {
    if (a.height != b.height || a.width != b.width)
        throw Error(ErrorKind::usage, name_ + ": expected two images of the same size, found " +
                                          size_text(a.width, a.height) + " and " +
                                          size_text(b.width, b.height));
    const FeatureMap &fa = a.layers[layer], &fb = b.layers[layer];
    const std::vector<float>& head = network_->heads[layer];
    Array2<float> out(fa.height(), fa.width());
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x) {
            const auto pa = fa.pixel(y, x), pb = fb.pixel(y, x);
            float sum = 0;
            for (std::size_t c = 0; c < head.size(); ++c)
                sum += head[c] * (pa[c] - pb[c]) * (pa[c] - pb[c]);
            out(y, x) = sum;
        }
    return out;
}

double Lpips::distance(const Features& a, const Features& b) const {
    double distance = 0;
    for (std::size_t layer = 0; layer < network_->layers.size(); ++layer) {
        const Array2<float> differences = layer_differences(a, b, layer);
        double sum = 0;
        for (const float v : differences.values()) sum += double(v);
        distance += sum / double(differences.values().size());
    }
    return distance;
}

Array2<float> Lpips::distance_map(const Features& a, const Features& b) const {
    Array2<float> map(a.height, a.width);
    for (std::size_t layer = 0; layer < network_->layers.size(); ++layer)
        add_upsampled(layer_differences(a, b, layer), map);
    return map;
}

std::unique_ptr<const Lpips> load_lpips(const std::filesystem::path& weights) {
    return weights.empty() ? nullptr : std::make_unique<const Lpips>(weights);
}

}  // namespace eventide
