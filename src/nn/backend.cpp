// What pays: a table for float32, one short measurement for bf16.
#include "src/nn/backend.h"

#include "src/nn/packed_conv.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <mutex>
#include <optional>

namespace eventide {
namespace {

constexpr int kSide = 48, kChannels = 16;  // of a tile at full resolution, where most products are

/// The shortest of a few runs: whatever else the machine does only adds.
double seconds_of(const Backend& backend) {
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
    const PackedConv conv{weights, 1, true, backend, {{kSide, kSide}}};
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

/// What comes later in the list must win clearly: bf16 costs accuracy, oneDNN allocations, and a
/// choice by a hair would differ from run to run.
Backend measure(Instructions most, bool onednn_allowed) {
    constexpr double kWorthwhile = 1.2;
    const Backend f32{&vector_kernels(most)}, bf16{f32.f32, bf16_kernels(most)},
        by_onednn{f32.f32, bf16.bf16, true};
    Backend best = f32;
    double least = seconds_of(f32);
    for (const Backend& candidate : {bf16, by_onednn}) {
        if (candidate.onednn && !(onednn_allowed && onednn_has_amx() && most == Instructions::best))
            continue;
        const double seconds = seconds_of(candidate);
        if (seconds * kWorthwhile > least) continue;
        best = candidate;
        least = seconds;
    }
    return best;
}

}  // namespace

std::string name_of(const Backend& backend) {
    if (!backend.onednn)
        return backend.bf16 == nullptr ? backend.f32->name
                                       : std::string{"bf16 ("} + backend.bf16->name + ")";
    if (backend.bf16 == nullptr) return "oneDNN";
    return onednn_has_amx() ? "bf16 (oneDNN, AMX)" : "bf16 (oneDNN)";
}

std::string engine_name(const Backend& backend) {
    return "fast, " + name_of(backend);
}

std::vector<Backend> all_backends() {
    std::vector<Backend> all;
    const auto add = [&](const Backend& backend) {
        if (std::ranges::find(all, backend) == all.end()) all.push_back(backend);
    };
    for (const Instructions most : kAllInstructions) {
        const VectorKernels* f32 = &vector_kernels(most);
        add({f32});
        add({f32, &plain::bf16_kernels()});
        if (const Bf16Kernels* bf16 = bf16_kernels(most)) add({f32, bf16});
    }
    const VectorKernels* best = &vector_kernels();
    if (onednn_available()) add({best, nullptr, true});
    if (onednn_has_bf16() && bf16_kernels() != nullptr) add({best, bf16_kernels(), true});
    return all;
}

Backend fastest_backend(Instructions most, bool bf16_allowed, bool onednn_allowed) {
    if (!bf16_allowed || bf16_kernels(most) == nullptr) return {&vector_kernels(most)};
    // Those with bf16: `best` and `avx512`.
    static std::mutex mutex;
    static std::array<std::optional<Backend>, 4> measured;
    const std::lock_guard lock{mutex};
    std::optional<Backend>& kept =
        measured[(most == Instructions::best ? 0U : 2U) + (onednn_allowed ? 1U : 0U)];
    if (!kept) kept = measure(most, onednn_allowed);
    return *kept;
}

}  // namespace eventide
