// What the loops of the fused renderer read and write.
#pragma once

#include <array>
#include <cstdint>

namespace eventide::fused {

/// Points that go through the layers together.
constexpr int kPoints = 32;

#if defined(__GNUC__)
#define EVENTIDE_INLINE __attribute__((always_inline)) inline
#else
#define EVENTIDE_INLINE inline
#endif

/// The weights, wide and in the order of the loops.
template <int H, typename W>
struct RenderWeights {
    std::array<W, 3 * H> offset{};            ///< [t, x, y][H]
    std::array<W, H * H> hidden{}, turned{};  ///< [in][out], [out][in]
    std::array<W, H> hidden_bias{};
    std::array<W, 2 * H> last{};  ///< [2][H]
    std::array<W, 2> last_bias{};
    W low = 0, high = 0;   ///< of ln sigma
    bool squares = false;  ///< the second output becomes sigma^2 + mu^2
};

/// Gradients by the weights, in the same shapes.
template <int H, typename W>
struct RenderGradients {
    std::array<W, 3 * H> offset{};
    std::array<W, H * H> hidden{};
    std::array<W, H> hidden_bias{};
    std::array<W, 2 * H> last{};
    std::array<W, 2> last_bias{};
};

/// A block of points of one row: where each one's sample begins, what lies between, and its weight.
template <typename W>
struct PointBlock {
    std::array<std::int64_t, kPoints> sample{};  ///< of the map, in numbers
    std::array<W, kPoints> dx{}, weight{};
    W dt = 0, dy = 0;
    int count = 0;
};

template <int H, typename W>
struct PointRoom {
    std::array<W, kPoints * H> first{}, second{}, g_first{}, g_second{};
    std::array<W, kPoints> mu{}, s{};
};

}  // namespace eventide::fused
