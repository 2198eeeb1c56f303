// Pixels of float32 numbers to pairs of bf16 numbers, by a function that converts a row.
#pragma once

#include <cstddef>
#include <cstdint>

namespace eventide {

/// [pixels][channels] to [pixels][(channels + 1) / 2] pairs. An even number of channels leaves no
/// gap, so all pixels are one row.
template <typename RowToBf16>
void convert_pixels(RowToBf16 row_to_bf16, const float* in, std::size_t pixels, int channels,
                    std::uint32_t* out) {
    auto* numbers = reinterpret_cast<std::uint16_t*>(out);
    const auto count = std::size_t(channels);
    if (channels % 2 == 0) {
        row_to_bf16(in, pixels * count, numbers);
        return;
    }
    for (std::size_t p = 0; p < pixels; ++p) {
        row_to_bf16(in + p * count, count, numbers + p * (count + 1));
        numbers[p * (count + 1) + count] = 0;
    }
}

}  // namespace eventide
