// Maps read at places between their pixels, row by row.
#include "src/model/render/followed_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace eventide {
namespace {

/// Bilinear at (y, x); beyond the edge the edge's.
double between_pixels(const Array2<float>& map, double y, double x) {
    y = std::clamp(y, 0., map.height() - 1.);
    x = std::clamp(x, 0., map.width() - 1.);
    double sum = 0;
    for (int v = 0; v < map.height(); ++v)
        for (int u = 0; u < map.width(); ++u)
            sum += std::max(0., 1 - std::abs(y - v)) * std::max(0., 1 - std::abs(x - u)) *
                   double(map(v, u));
    return sum;
}

TEST(DisplacedRow, IsBilinearInMapsOfAnySizeAndEndsAtTheirEdges) {
    std::mt19937 random{1};
    std::uniform_real_distribution<float> value{0, 1}, displacement{-3, 3};
    for (const auto& [height, width] :
         {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 2}, {3, 2}, {2, 3}, {5, 130}}) {
        Array2<float> map(height, width);
        for (float& v : map.values()) v = value(random);
        std::vector<float> dx(std::size_t(width), 0), dy = dx, row = dx;
        for (int y = 0; y < height; ++y) {
            for (std::vector<float>* each : {&dx, &dy})
                for (float& d : *each) d = displacement(random);
            displaced_row(map, y, dx, dy, row);
            for (std::size_t x = 0; x < row.size(); ++x)
                ASSERT_NEAR(
                    row[x],
                    between_pixels(map, double(y) + double(dy[x]), double(x) + double(dx[x])), 1e-4)
                    << height << 'x' << width << ": " << y << ',' << x;
        }
    }
}

TEST(DisplacedRow, ByNothingIsTheRow) {
    Array2<float> map(2, 70);
    for (std::size_t i = 0; i < map.values().size(); ++i) map.values()[i] = float(i);
    const std::vector<float> none(70, 0);
    std::vector<float> row(70, -1);
    displaced_row(map, 1, none, none, row);
    EXPECT_TRUE(std::ranges::equal(row, map.row(1)));
}

}  // namespace
}  // namespace eventide
