// Resampling, the pyramid, and the look-up, which is the innermost loop of the simulator.
#include "src/simulate/scene/texture.h"

#include "src/core/error.h"
#include "src/core/simd4.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace eventide {

namespace {

constexpr int kLargestLog2 = 10;

int nearest_log2(int size) {
    return std::clamp(int(std::lround(std::log2(size))), 1, kLargestLog2);
}

/// Index into n values that go on mirrored (edge values twice).
int mirrored(int i, int n) {
    i = ((i % (2 * n)) + 2 * n) % (2 * n);
    return i < n ? i : 2 * n - 1 - i;
}

/// One row or column resampled to n values with a tent as wide as the coarser of the two grids.
std::vector<float> resampled(const std::vector<float>& from, int n) {
    const int m = int(from.size());
    const double ratio = double(m) / n, reach = std::max(1.0, ratio);
    std::vector<float> to(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
        const double centre = (i + .5) * ratio - .5;
        double sum = 0, weights = 0;
        for (int j = int(std::ceil(centre - reach)); j <= int(std::floor(centre + reach)); ++j) {
            const double weight = 1 - std::abs(j - centre) / reach;
            sum += weight * double(from[std::size_t(mirrored(j, m))]);
            weights += weight;
        }
        to[std::size_t(i)] = float(sum / weights);
    }
    return to;
}

Array2<float> resampled(const Array2<float>& image, int height, int width) {
    Array2<float> wide(image.height(), width), out(height, width);
    for (int y = 0; y < image.height(); ++y) {
        const auto row = image.row(y);
        std::ranges::copy(resampled(std::vector<float>(row.begin(), row.end()), width),
                          wide.row(y).begin());
    }
    std::vector<float> column(static_cast<std::size_t>(image.height()));
    for (int x = 0; x < width; ++x) {
        for (int y = 0; y < image.height(); ++y) column[std::size_t(y)] = wide(y, x);
        const std::vector<float> result = resampled(column, height);
        for (int y = 0; y < height; ++y) out(y, x) = result[std::size_t(y)];
    }
    return out;
}

/// Half the size by the weights 1 3 3 1, which let less alias through than a plain mean of two.
Array2<float> halved(const Array2<float>& image) {
    const int h = image.height(), w = image.width();
    const int half_h = std::max(1, h / 2), half_w = std::max(1, w / 2);
    Array2<float> wide(h, half_w), out(half_h, half_w);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < half_w; ++x) {
            const auto at = [&](int i) { return image(y, mirrored(2 * x + i, w)); };
            wide(y, x) = w == 1 ? at(0) : (at(-1) + 3 * (at(0) + at(1)) + at(2)) / 8;
        }
    for (int y = 0; y < half_h; ++y)
        for (int x = 0; x < half_w; ++x) {
            const auto at = [&](int i) { return wide(mirrored(2 * y + i, h), x); };
            out(y, x) = h == 1 ? at(0) : (at(-1) + 3 * (at(0) + at(1)) + at(2)) / 8;
        }
    return out;
}

std::uint32_t turns(double images) {
    const double halves = images / 2;
    return std::uint32_t(std::int64_t((halves - std::floor(halves)) * 0x1p32));
}

/// Two neighbouring texels of a row in one word.
std::uint32_t pair_at(const std::uint16_t* p) {
    std::uint32_t word;
    std::memcpy(&word, p, sizeof word);
    if constexpr (std::endian::native == std::endian::big) word = std::rotl(word, 16);
    return word;
}

}  // namespace

Texture::Texture(const Array2<std::uint8_t>& grey) : height_(grey.height()) {
    if (grey.height() < 2 || grey.width() < 2)
        throw Error(ErrorKind::input, "a texture needs at least 2 x 2 pixels, but has " +
                                          std::to_string(grey.width()) + " x " +
                                          std::to_string(grey.height()));
    aspect_ = double(grey.width()) / grey.height();
    const auto [darkest, brightest] = std::ranges::minmax(grey.values());
    const float scale = 1.f / std::max(1.f, float(brightest) - float(darkest));
    Array2<float> image(grey.height(), grey.width());
    for (std::size_t i = 0; i < grey.values().size(); ++i)
        image.values()[i] = (float(grey.values()[i]) - float(darkest)) * scale;
    image = resampled(image, 1 << nearest_log2(grey.height()), 1 << nearest_log2(grey.width()));
    for (;;) {
        levels_.push_back(make_level(image));
        if (image.height() == 1 && image.width() == 1) break;
        image = halved(image);
    }
}

Texture::Level Texture::make_level(const Array2<float>& image) {
    Level level{.log2_width = int(std::bit_width(unsigned(image.width())) - 1),
                .log2_height = int(std::bit_width(unsigned(image.height())) - 1),
                .texels = {}};
    for (int y = -1; y <= image.height(); ++y)
        for (int x = -1; x <= image.width(); ++x) {
            const float v = image(mirrored(y, image.height()), mirrored(x, image.width()));
            // NOLINTNEXTLINE(bugprone-incorrect-roundings): never below 0
            level.texels.push_back(std::uint16_t(std::clamp(v, 0.f, 1.f) * 65535 + .5f));
        }
    return level;
}

Texture::Walk Texture::walk(const Affine& to_image, int x, int y) {
    const Point p = to_image({double(x), double(y)});
    return {turns(p.x), turns(p.y), turns(to_image.xx), turns(to_image.yx)};
}

float Texture::detail(const Affine& to_image) const {
    const double w = double(1 << levels_[0].log2_width), h = double(1 << levels_[0].log2_height);
    const double square = (to_image.xx * to_image.xx + to_image.xy * to_image.xy) * w * w +
                          (to_image.yx * to_image.yx + to_image.yy * to_image.yy) * h * h;
    // The levels' own filter blurs a little more than a pixel's area does: a quarter level less.
    constexpr double kBias = .25;
    const double detail = .5 * std::log2(square / 2 + 1e-12) - kBias;
    return float(std::clamp(detail, 0.0, double(levels_.size() - 1)));
}

namespace {

/// What the innermost loop needs of one level, in registers.
struct LookUp {
    const std::uint16_t* texels;
    std::uint32_t log2_width, shift_u, shift_v;

    LookUp(const std::vector<std::uint16_t>& values, int width_log2, int height_log2)
        : texels(values.data()),
          log2_width(std::uint32_t(width_log2)),
          shift_u(31 - log2_width),
          shift_v(31 - std::uint32_t(height_log2)) {}

    lanes::F4 operator()(lanes::U4 u, lanes::U4 v) const {
        using namespace lanes;
        u += std::uint32_t(1) << (shift_u - 1);  // half a texel: texels are told by their centres
        v += std::uint32_t(1) << (shift_v - 1);
        const U4 i = u >> shift_u, j = v >> shift_v;
        const std::uint32_t stride = (std::uint32_t(1) << log2_width) + 2;
        const U4 index = (j << log2_width) + (j + j) + i;  // j stride + i
        std::uint32_t at[4];
        std::memcpy(at, &index, sizeof at);
        const std::uint16_t* next = texels + stride;
        const U4 above{pair_at(texels + at[0]), pair_at(texels + at[1]), pair_at(texels + at[2]),
                       pair_at(texels + at[3])};
        const U4 below{pair_at(next + at[0]), pair_at(next + at[1]), pair_at(next + at[2]),
                       pair_at(next + at[3])};
        const F4 fu = fraction(u, shift_u), fv = fraction(v, shift_v);
        const F4 a = to_float(above & 0xffffu), b = to_float(above >> 16);
        const F4 c = to_float(below & 0xffffu), d = to_float(below >> 16);
        const F4 left = a + (c - a) * fv, right = b + (d - b) * fv;
        return left + (right - left) * fu;
    }

private:
    static lanes::F4 fraction(lanes::U4 place, std::uint32_t shift) {
        const std::uint32_t one = std::uint32_t(1) << shift;
        return lanes::to_float(place & (one - 1)) * (1.f / float(one));
    }
};

}  // namespace

void Texture::sample(const Walk& walk, float detail, std::span<float> out) const {
    using namespace lanes;
    const std::size_t fine = std::size_t(detail);
    const std::size_t coarse = std::min(fine + 1, levels_.size() - 1);
    constexpr float kUnit = 1.f / 65535;
    const float share = (detail - float(fine)) * kUnit;
    const bool blend = share > 1e-4f * kUnit && coarse > fine;
    const auto view = [](const Level& l) { return LookUp{l.texels, l.log2_width, l.log2_height}; };
    const LookUp look_fine = view(levels_[fine]), look_coarse = view(levels_[coarse]);

    const U4 ramp{0, 1, 2, 3};
    U4 u = splat(walk.u) + ramp * walk.du, v = splat(walk.v) + ramp * walk.dv;
    float* to = out.data();
    for (float* const end = to + out.size(); to != end; to += 4) {
        const U4 mu = u ^ U4(I4(u) >> 31), mv = v ^ U4(I4(v) >> 31);  // the mirrored half
        F4 value = look_fine(mu, mv);
        value = blend ? value * (kUnit - share) + look_coarse(mu, mv) * share : value * kUnit;
        store(to, value);
        u += 4 * walk.du;
        v += 4 * walk.dv;
    }
}

}  // namespace eventide
