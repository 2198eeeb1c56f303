// See vector_kernels.h. This text is compiled once per instruction set (foreach_target.h).
#include "src/kernels/vector_kernels.h"

#include <array>
#include <iterator>

// Vectors of unknown length cannot be members of a struct, which the register blocks here are.
// SSSE3: processors that have it and not SSE4 are of 2006; they run scalar kernels.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/kernels/vector_kernels.cpp"
#include <hwy/foreach_target.h>
#include "src/kernels/hidden_rows-inl.h"
#include "src/kernels/render_kernels-inl.h"
#include "src/kernels/vector_dots-inl.h"
#include "src/kernels/vector_maps-inl.h"
#include "src/kernels/vector_winograd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eventide::HWY_NAMESPACE {

/// A line is fetched while one is worked on: all at once they would wait for each other.
void compress(const float* in, float* out, std::size_t n, std::ptrdiff_t ahead) {
    const D d;
    constexpr std::size_t kLine = 64 / sizeof(float);
    const std::size_t lanes = hn::Lanes(d);
    const Compress compressed;
    std::size_t i = 0;
    for (; i + kLine <= n; i += kLine) {
        __builtin_prefetch(in + i + ahead);
        for (std::size_t k = i; k < i + kLine; k += lanes) {
            const V v = hn::LoadU(d, in + k);
            hn::StoreU(compressed(v, v, v, v), d, out + k);
        }
    }
    __builtin_prefetch(in + i + ahead);
    map(compressed, n - i, out + i, in + i, in + i, in + i, in + i);
}
void sigmoid_row(float* g, std::size_t n) {
    map(Sigmoid{}, n, g, g, g, g, g);
}
void reset_state(const float* r, std::ptrdiff_t r_step, const float* h, float* out, int channels,
                 int pixels) {
    if (channels <= kNarrowLanes)
        return reset_pixels(Narrow(), r, r_step, h, out, channels, pixels);
    reset_pixels(D(), r, r_step, h, out, channels, pixels);
}
void update_state(const float* h, const float* u, std::ptrdiff_t u_step, float* candidate,
                  float* out, int channels, int pixels) {
    map(Tanh{}, std::size_t(channels) * std::size_t(pixels), candidate, candidate, candidate,
        candidate, candidate);
    const auto update = [&](auto d) HWY_ATTR {
        update_pixels(d, h, u, u_step, candidate, channels, AsItIs{}, out, channels, pixels);
    };
    if (channels <= kNarrowLanes) return update(Narrow());
    update(D());
}
void update_light(const float* h, const float* halves, float* out, int channels, int pixels) {
    const std::ptrdiff_t step = 2 * std::ptrdiff_t{channels};
    const auto update = [&](auto d) HWY_ATTR {
        update_pixels(d, h, halves, step, halves + channels, step, TanhOfSigmoid{}, out, channels,
                      pixels);
    };
    if (channels <= kNarrowLanes) return update(Narrow());
    update(D());
}
void add_relu(const float* a, const float* b, float* out, std::size_t n) {
    map(AddRelu{}, n, out, a, b, a, a);
}
void norm_elu(const float* a, const float* scale, const float* shift, const float* skip, float* out,
              std::size_t pixels, int channels) {
    const auto count = std::size_t(channels);
    for (std::size_t p = 0; p < pixels; ++p) {
        const std::size_t at = p * count;
        if (skip != nullptr)
            map(NormElu{}, count, out + at, a + at, scale, shift, skip + at);
        else
            map(NormEluAlone{}, count, out + at, a + at, scale, shift, shift);
    }
}
void elu(const float* in, float* out, std::size_t n) {
    map(Elu{}, n, out, in, in, in, in);
}
void double_row(const DoubleRow& r) {
    std::ptrdiff_t c = 0;
    const auto blocks = [&](auto d) HWY_ATTR {
        for (const auto lanes = std::ptrdiff_t(hn::Lanes(d)); c + lanes <= r.channels; c += lanes)
            double_channels(d, r, c);
    };
    blocks(D());
    blocks(Narrow());  // half a register of AVX-512
    blocks(hn::CappedTag<float, 1>());
}

bool are_near(const float* a, const float* b, float bound, std::size_t n) {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    const V most = hn::Set(d, bound);
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes)
        if (!hn::AllTrue(d, hn::Le(hn::AbsDiff(hn::LoadU(d, a + i), hn::LoadU(d, b + i)), most)))
            return false;
    return i == n ||
           hn::AllTrue(d,
                       hn::Le(hn::AbsDiff(load_some(a + i, n - i), load_some(b + i, n - i)), most));
}

/// As processors' documents say it; Highway's targets are smaller the more they can.
const char* name_of_target() {
    return HWY_TARGET <= HWY_AVX3 ? "AVX-512" : hwy::TargetName(HWY_TARGET);
}

const VectorKernels* table() {
    static const VectorKernels kernels{.name = name_of_target(),
                                       .lanes = int(hn::Lanes(D())),
                                       .by_quads = kByQuads,
                                       .dot_area = dot_area,
                                       .winograd_input = winograd_input,
                                       .winograd_output = winograd_output,
                                       .compress = compress,
                                       .sigmoid = sigmoid_row,
                                       .reset_state = reset_state,
                                       .update_state = update_state,
                                       .update_light = update_light,
                                       .add_relu = add_relu,
                                       .norm_elu = norm_elu,
                                       .elu = elu,
                                       .double_row = double_row,
                                       .are_near = are_near,
                                       .offset_rows = offset_rows,
                                       .two_outputs = two_outputs,
                                       .hidden_rows = hidden_rows,
                                       .weigh_rows = weigh_rows,
                                       .scaled_exp = scaled_exp};
    return &kernels;
}

}  // namespace eventide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eventide {
namespace {

HWY_EXPORT(table);

std::int64_t left_out(Instructions most) {
    switch (most) {
        case Instructions::best:
        case Instructions::avx512:
            return 0;
        case Instructions::avx2:
            return HWY_AVX3 | HWY_AVX3_DL;
        case Instructions::sse4:
            return HWY_AVX2 | HWY_AVX3 | HWY_AVX3_DL;
    }
    return 0;
}

/// Every 64-bit ARM has NEON. What Highway calls so has instructions for AES, too, which some lack
/// (the Raspberry Pi 4) and nothing here uses.
constexpr std::int64_t kAlwaysThere = HWY_ARCH_ARM_A64 ? HWY_NEON : 0;

}  // namespace

/// Not HWY_DYNAMIC_DISPATCH(): what that chooses is the whole process's. Highway asks the processor
/// each time, which a virtual machine makes slow: once is enough.
const VectorKernels& vector_kernels(Instructions most) {
    static const auto all = [] {
        std::array<const VectorKernels*, std::size(kAllInstructions)> tables{};
        for (const Instructions each : kAllInstructions) {
            hwy::ChosenTarget chosen;
            chosen.Update((hwy::SupportedTargets() | kAlwaysThere) & ~left_out(each));
            tables[std::size_t(each)] = HWY_DISPATCH_TABLE(table)[chosen.GetIndex()]();
        }
        return tables;
    }();
    return *all[std::size_t(most)];
}

int dot_lanes(const VectorKernels& kernels, int outputs) {
    return outputs <= kNarrowLanes ? std::min(kNarrowLanes, kernels.lanes) : kernels.lanes;
}

std::size_t packed_size(int stretches, int length, int outputs, int lanes) {
    const int padded = (outputs + lanes - 1) / lanes * lanes;
    return std::size_t(stretches) * std::size_t(length) * std::size_t(padded);
}

}  // namespace eventide
#endif
