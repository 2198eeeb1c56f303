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

/// One layer on one backend, timed again and again: from and to numbers of the kind that layers
/// read, as networks run it.
class LayerTrial {
public:
    explicit LayerTrial(const Backend& backend)
        : conv_(layer(), 1, true, backend, {{kSide, kSide}}),
          scratch_(conv_.scratch_size(kSide, kSide)),
          in_(kSide + 2, kSide + 2, conv_.numbers().units(kChannels)),
          out_(kSide, kSide, in_.channels()) {
        std::ranges::fill(in_.values(), 1.0F);
    }

    void run() {
        const ConvArea area{.in = {{{in_.values().data(), pitch(in_)}}},
                            .out = out_.values().data(),
                            .out_pitch = pitch(out_),
                            .to_bf16 = true,
                            .height = kSide,
                            .width = kSide};
        const auto begin = std::chrono::steady_clock::now();
        conv_.run(area, scratch_.data());
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        least_ = std::min(least_, taken.count());
    }

    /// s, the shortest: whatever else the machine does only adds.
    double least() const { return least_; }

private:
    static plain::ConvWeights<float> layer() {
        plain::ConvWeights<float> weights{kChannels, kChannels, {}, {}};
        weights.weight.assign(std::size_t(kChannels) * kChannels * 9, 0.1F);
        weights.bias.assign(kChannels, 0.0F);
        return weights;
    }
    static std::ptrdiff_t pitch(const Array3<float>& map) {
        return std::ptrdiff_t(map.width()) * map.channels();
    }

    PackedConv conv_;
    std::vector<float> scratch_;
    Array3<float> in_, out_;
    double least_ = std::numeric_limits<double>::infinity();
};

/// What comes later in the list must win clearly: bf16 costs accuracy, oneDNN allocations, and a
/// choice by a hair would differ from run to run. A network gains more by bf16 than this layer, as
/// its maps are half as large (Zen 4: 1.5 times, the layer 1.3). The candidates take turns, so that
/// a moment in which the machine is busy does not fall on one alone.
Backend measure(Instructions most, bool onednn_allowed) {
    struct Candidate {
        Backend backend;
        double worthwhile;  ///< how many times as fast as the best before
    };
    constexpr int kRounds = 16;
    const Backend f32{&vector_kernels(most)}, bf16{f32.f32, bf16_kernels(most)};
    std::vector<Candidate> candidates{{f32, 1}, {bf16, 1.1}};
    if (onednn_allowed && onednn_has_amx() && most == Instructions::best)
        candidates.push_back({{f32.f32, bf16.bf16, true}, 1.2});
    std::vector<LayerTrial> trials;
    trials.reserve(candidates.size());
    for (const Candidate& candidate : candidates) trials.emplace_back(candidate.backend);
    for (int round = 0; round < kRounds; ++round)
        for (LayerTrial& trial : trials) trial.run();
    std::size_t best = 0;
    for (std::size_t i = 1; i < trials.size(); ++i)
        if (trials[i].least() * candidates[i].worthwhile <= trials[best].least()) best = i;
    return candidates[best].backend;
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
