// Frames as plain numbers, intensity and sigma in one of four arrangements.
#include "pipeline/sinks/raw_pixels.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

namespace eventide {

static_assert(std::endian::native == std::endian::little, "the raw streams are little endian");

namespace {

void convert(std::span<const float> from, float white, std::span<std::uint8_t> into) {
    to_grey8(from, white, into);
}
void convert(std::span<const float> from, float white, std::span<std::uint16_t> into) {
    to_grey16(from, white, into);
}
void convert(std::span<const float> from, float, std::span<float> into) {
    std::ranges::copy(from, into.begin());
}

template <typename T>
void append(std::span<const T> numbers, std::vector<std::byte>& into) {
    const auto bytes = std::as_bytes(numbers);
    into.insert(into.end(), bytes.begin(), bytes.end());
}

template <typename T>
void append_row(std::span<const float> row, float white, std::vector<T>& scratch,
                std::vector<std::byte>& into) {
    scratch.resize(row.size());
    convert(row, white, std::span<T>{scratch});
    append(std::span<const T>{scratch}, into);
}

/// Interleaves intensity and confidence, 1 - sigma / sigma_white.
template <typename T>
void append_alpha_row(std::span<const float> row, std::span<const float> sigma, float white,
                      std::vector<float>& pairs, std::vector<T>& scratch,
                      std::vector<std::byte>& into) {
    pairs.clear();
    for (std::size_t x = 0; x < row.size(); ++x) {
        pairs.push_back(row[x]);
        pairs.push_back(1.0f - std::clamp(sigma[x] / white, 0.0f, 1.0f));
    }
    append_row<T>(pairs, 1.0f, scratch, into);
}

}  // namespace

template <typename T>
void append_pixels(const Frame& frame, const RawLayout& layout, std::vector<std::byte>& into) {
    const int height = frame.intensity.height();
    const std::vector<float> zeros(std::size_t(frame.intensity.width()), 0.0f);
    std::vector<T> scratch;
    std::vector<float> pairs;
    const auto sigma = [&](int y) {
        return frame.sigma.empty() ? std::span<const float>{zeros} : frame.sigma.row(y);
    };
    for (int y = 0; y < height; ++y) {
        if (layout.uncertainty == Uncertainty::alpha) {
            append_alpha_row<T>(frame.intensity.row(y), sigma(y), layout.sigma_white, pairs,
                                scratch, into);
            continue;
        }
        append_row<T>(frame.intensity.row(y), 1.0f, scratch, into);
        if (layout.uncertainty == Uncertainty::side)
            append_row<T>(sigma(y), layout.sigma_white, scratch, into);
    }
    if (layout.uncertainty == Uncertainty::separate)
        for (int y = 0; y < height; ++y) append_row<T>(sigma(y), layout.sigma_white, scratch, into);
}

template void append_pixels<std::uint8_t>(const Frame&, const RawLayout&, std::vector<std::byte>&);
template void append_pixels<std::uint16_t>(const Frame&, const RawLayout&, std::vector<std::byte>&);
template void append_pixels<float>(const Frame&, const RawLayout&, std::vector<std::byte>&);

}  // namespace eventide
