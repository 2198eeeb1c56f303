// What pays: a table for float32, one short measurement for bf16.
#include "src/nn/arithmetic.h"

#include "src/kernels/bf16_kernels.h"
#include "src/kernels/vector_kernels.h"
#include "src/nn/packed_layers.h"

#include <algorithm>
#include <chrono>
#include <limits>

namespace eventide {
namespace {

constexpr int kSide = 24, kChannels = 64;  // of a typical layer's tile

/// The shortest of a few runs: whatever else the machine does only adds.
double seconds_of(const Arithmetic& arithmetic) {
    plain::ConvWeights<float> weights{kChannels, kChannels, {}, {}};
    weights.weight.assign(std::size_t(kChannels) * kChannels * 9, 0.1F);
    weights.bias.assign(kChannels, 0.0F);
    Array3<float> in{kSide + 2, kSide + 2, kChannels}, out{kSide, kSide, kChannels};
    std::ranges::fill(in.values(), 1.0F);
    const ConvCall call{in.values().data(),
                        std::ptrdiff_t(kSide + 2) * kChannels,
                        out.values().data(),
                        std::ptrdiff_t(kSide) * kChannels,
                        kChannels,
                        kSide,
                        kSide};
    const PackedConv conv{weights, 1, true, arithmetic, {{kSide, kSide}}};
    std::vector<float> scratch(conv.scratch_size(kSide, kSide));
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 12; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        conv.run(call, scratch.data());
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        best = std::min(best, taken.count());
    }
    return best;
}

constexpr Arithmetic kFloat{Products::f32, false};
constexpr Arithmetic kBf16{Products::bf16, false};
constexpr Arithmetic kBf16ByOnednn{Products::bf16, true};

/// What comes later in the list must win clearly: bf16 costs accuracy, oneDNN allocations, and a
/// choice by a hair would differ from run to run.
Arithmetic measure(bool onednn_allowed) {
    constexpr double kWorthwhile = 1.2;
    Arithmetic best = kFloat;
    double least = seconds_of(kFloat);
    for (const Arithmetic& candidate : {kBf16, kBf16ByOnednn}) {
        if (candidate.onednn && !(onednn_allowed && onednn_has_amx() && !amx_left_out())) continue;
        const double seconds = seconds_of(candidate);
        if (seconds * kWorthwhile > least) continue;
        best = candidate;
        least = seconds;
    }
    return best;
}

}  // namespace

const char* name_of(const Arithmetic& arithmetic) {
    if (arithmetic.products == Products::bf16_emulated) return "bf16 (emulated)";
    if (!arithmetic.onednn) {
        if (!arithmetic.bf16()) return vector_kernels().name;
        return amx_available() ? "bf16 (AMX)" : "bf16 (AVX512_BF16)";
    }
    if (!arithmetic.bf16()) return "oneDNN";
    return onednn_has_amx() ? "bf16 (oneDNN, AMX)" : "bf16 (oneDNN)";
}

std::string engine_name(const Arithmetic& arithmetic) {
    return std::string{"fast, "} + name_of(arithmetic);
}

bool bf16_available() {
    return bf16_kernels() != nullptr;
}

bool amx_available() {
    return amx_kernels() != nullptr;
}

Arithmetic best_arithmetic(bool bf16_allowed, bool onednn_allowed) {
    if (!bf16_allowed || !bf16_available()) return kFloat;
    static const Arithmetic any = measure(true), own = measure(false);
    return onednn_allowed ? any : own;
}

}  // namespace eventide
