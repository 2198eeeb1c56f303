// What numbers layers read: float32, or bf16 in pairs.
#pragma once

#include "src/kernels/quad_dots.h"
#include "src/nn/backend.h"

#include <cstring>

namespace eventide {

/// Pixels of so many bf16 numbers, with a zero beside the last of an odd number, to float32.
inline void pixels_from_bf16(const void* in, std::size_t pixels, int channels,
                             float* out) noexcept {
    const auto* numbers = static_cast<const std::uint16_t*>(in);
    const auto count = std::size_t(channels), step = (count + 1) / 2 * 2;
    for (std::size_t p = 0; p < pixels; ++p)
        for (std::size_t c = 0; c < count; ++c)
            out[p * count + c] = from_bf16(numbers[p * step + c]);
}

/// Maps and rows that layers read count units of 4 bytes: a float32 number, or two bf16 numbers of
/// the same pixel, with a zero beside the last of an odd number.
class Numbers {
public:
    Numbers() = default;
    explicit Numbers(const Backend& backend) : f32_(backend.f32), bf16_(backend.bf16) {}

    /// Kernels for all but products.
    const VectorKernels& kernels() const { return *f32_; }
    /// Null where they are float32.
    const Bf16Kernels* bf16() const { return bf16_; }
    /// Whether layers of 8 and 16 outputs go by quads of units (quad_dots.h).
    bool by_quads() const { return bf16_ != nullptr ? bf16_->by_quads : f32_->by_quads; }
    int units(int channels) const { return bf16_ != nullptr ? (channels + 1) / 2 : channels; }

    /// Pixels of so many channels, one after the other, from float32 and back.
    void from_float(const float* in, std::size_t pixels, int channels, void* out) const noexcept {
        if (bf16_ != nullptr)
            bf16_->pixels_to_bf16(in, pixels, channels, static_cast<std::uint32_t*>(out));
        else
            std::memcpy(out, in, pixels * std::size_t(channels) * sizeof(float));
    }
    void to_float(const void* in, std::size_t pixels, int channels, float* out) const noexcept {
        if (bf16_ != nullptr)
            pixels_from_bf16(in, pixels, channels, out);
        else
            std::memcpy(out, in, pixels * std::size_t(channels) * sizeof(float));
    }
    /// See DoubleRow.
    void double_row(DoubleRow row) const noexcept {
        if (bf16_ == nullptr) {
            f32_->double_row(row);
            return;
        }
        row.channels = 2 * units(row.channels);
        bf16_->double_row(row);
    }
    /// See OffsetRows.
    void offset_rows(const OffsetRows& rows) const noexcept {
        bf16_ != nullptr ? bf16_->offset_rows(rows) : f32_->offset_rows(rows);
    }

private:
    const VectorKernels* f32_ = &vector_kernels();
    const Bf16Kernels* bf16_ = nullptr;
};

}  // namespace eventide
