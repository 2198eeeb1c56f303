// Textures made from nothing: so that the demo and the tests need no image.
#include "src/simulate/random.h"
#include "src/simulate/scene/texture_pack.h"
#include "src/simulate/scene/textures.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace eventide {

namespace {

using Canvas = Array2<float>;

GreyImage to_grey(const Canvas& canvas) {
    GreyImage image(canvas.height(), canvas.width());
    const auto [low, high] = std::ranges::minmax(canvas.values());
    const float scale = 255.f / std::max(1e-6f, high - low);
    for (std::size_t i = 0; i < canvas.values().size(); ++i)
        // NOLINTNEXTLINE(bugprone-incorrect-roundings): never below 0
        image.values()[i] = std::uint8_t((canvas.values()[i] - low) * scale + .5f);
    return image;
}

/// Smooth noise of one scale: random values on a coarse grid, blended by the smoothstep curve.
void add_noise(Canvas& canvas, int cells, float amplitude, Random& random) {
    Array2<float> grid(cells + 1, cells + 1);
    for (float& v : grid.values()) v = float(random.uniform({-1, 1})) * amplitude;
    // Cell and share of the way to the next, of each pixel in one direction.
    const auto places = [cells](int n) {
        std::vector<std::pair<int, float>> out;
        for (int i = 0; i < n; ++i) {
            const float s = float(i) * float(cells) / float(n), f = s - std::floor(s);
            out.emplace_back(int(s), f * f * (3 - 2 * f));
        }
        return out;
    };
    const auto columns = places(canvas.width()), rows = places(canvas.height());
    std::vector<float> blended(static_cast<std::size_t>(cells + 1));
    for (int y = 0; y < canvas.height(); ++y) {
        const auto [j, v] = rows[std::size_t(y)];
        for (int i = 0; i <= cells; ++i)
            blended[std::size_t(i)] = grid(j, i) + v * (grid(j + 1, i) - grid(j, i));
        const std::span<float> row = canvas.row(y);
        for (std::size_t x = 0; x < row.size(); ++x) {
            const auto [i, u] = columns[x];
            const float left = blended[std::size_t(i)], right = blended[std::size_t(i) + 1];
            row[x] += left + u * (right - left);
        }
    }
}

/// Every octave a factor `roughness` weaker than the coarser one before it.
void add_clouds(Canvas& canvas, float amplitude, float roughness, Random& random) {
    for (int cells = 2; cells <= canvas.width() / 4; cells *= 2, amplitude *= roughness)
        add_noise(canvas, cells, amplitude, random);
}

void fill_rectangle(Canvas& canvas, double x0, double y0, double w, double h, float value) {
    const auto clip = [](double v, int n) { return std::clamp(int(std::lround(v)), 0, n); };
    for (int y = clip(y0, canvas.height()); y < clip(y0 + h, canvas.height()); ++y)
        for (int x = clip(x0, canvas.width()); x < clip(x0 + w, canvas.width()); ++x)
            canvas(y, x) = value;
}

/// A convex polygon around a centre.
void fill_polygon(Canvas& canvas, Random& random, float value) {
    const double cx = random.uniform({0, double(canvas.width())});
    const double cy = random.uniform({0, double(canvas.height())});
    const double radius = random.log_uniform({.03, .3}) * canvas.width();
    const int corners = random.integer(3, 7);
    struct Side {
        double nx, ny, distance;
    };
    std::vector<Side> sides;
    for (int i = 0; i < corners; ++i) {
        const double angle = (i + random.uniform({-.3, .3})) * 2 * std::numbers::pi / corners;
        sides.push_back({std::cos(angle), std::sin(angle), radius * random.uniform({.4, 1})});
    }
    const auto clip = [](double v, int n) { return std::clamp(int(v), 0, n); };
    for (int y = clip(cy - 2 * radius, canvas.height()); y < clip(cy + 2 * radius, canvas.height());
         ++y)
        for (int x = clip(cx - 2 * radius, canvas.width());
             x < clip(cx + 2 * radius, canvas.width()); ++x)
            if (std::ranges::all_of(sides, [&](const Side& side) {
                    return (x - cx) * side.nx + (y - cy) * side.ny < side.distance;
                }))
                canvas(y, x) = value;
}

void draw_checkers(Canvas& canvas, Random& random) {
    const int cell = random.integer(canvas.width() / 32 + 1, canvas.width() / 6);
    const float dark = float(random.uniform({0, .4})), bright = float(random.uniform({.6, 1}));
    for (int y = 0; y < canvas.height(); ++y)
        for (int x = 0; x < canvas.width(); ++x)
            canvas(y, x) = ((x / cell + y / cell) % 2 == 0) ? dark : bright;
    add_clouds(canvas, .15f, .6f, random);
}

void draw_bars(Canvas& canvas, Random& random) {
    double x = 0;
    const bool upright = random.chance(.5);
    while (x < canvas.width()) {
        const double w = random.log_uniform({.01, .12}) * canvas.width() + 1;
        const float value = float(random.uniform());
        if (upright)
            fill_rectangle(canvas, x, 0, w, canvas.height(), value);
        else
            fill_rectangle(canvas, 0, x, canvas.width(), w, value);
        x += w;
    }
    add_clouds(canvas, .1f, .6f, random);
}

/// Dark blobs in words and lines on light ground.
void draw_text(Canvas& canvas, Random& random) {
    for (float& v : canvas.values()) v = .9f;
    add_clouds(canvas, .08f, .5f, random);
    const double height = random.log_uniform({.02, .09}) * canvas.width() + 3;
    for (double y = height; y + height < canvas.height(); y += 1.7 * height)
        for (double x = height; x + height < canvas.width(); x += random.chance(.2) ? height : 0) {
            const double w = height * random.uniform({.3, .7});
            const float ink = float(random.uniform({0, .25}));
            for (int stroke = random.integer(2, 4); stroke > 0; --stroke) {
                const bool upright = random.chance(.5);
                const double thick = std::max(1.0, height * .16);
                fill_rectangle(canvas, x + (upright ? random.uniform({0, w - thick}) : 0),
                               y + (upright ? 0 : random.uniform({0, height - thick})),
                               upright ? thick : w, upright ? height : thick, ink);
            }
            x += w + height * .15;
        }
}

void draw_polygons(Canvas& canvas, Random& random) {
    add_clouds(canvas, .3f, .5f, random);
    for (int n = random.integer(10, 60); n > 0; --n)
        fill_polygon(canvas, random, float(random.uniform({-.6, .9})));
    add_clouds(canvas, .08f, .8f, random);
}

}  // namespace

GreyImage procedural_image(std::size_t i, int side, std::uint64_t seed) {
    Random random{seed * 1000003 + i};
    Canvas canvas(2 * side, 2 * side);  // and then shrunk, which smooths the edges
    switch (i % 5) {
        case 0:
            add_clouds(canvas, 1, float(random.uniform({.5, .85})), random);
            break;
        case 1:
            draw_checkers(canvas, random);
            break;
        case 2:
            draw_polygons(canvas, random);
            break;
        case 3:
            draw_text(canvas, random);
            break;
        default:
            draw_bars(canvas, random);
            break;
    }
    return shrunk(to_grey(canvas), side);
}

std::shared_ptr<TextureLibrary> procedural_textures(std::size_t count, int side,
                                                    std::uint64_t seed) {
    auto library = std::make_shared<TextureLibrary>();
    for (std::size_t i = 0; i < count; ++i) library->add(procedural_image(i, side, seed));
    return library;
}

}  // namespace eventide
