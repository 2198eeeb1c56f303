// Every 3x3 convolution of the shipped default on its own, at its tile's size: our kernels beside
// oneDNN's, in float32 and bf16, both called as the encoder calls them (oneDNN gathers its input
// into a dense block and puts its output where it belongs). "peak" is what no kernel can pass.
#include "src/nn/packed_conv.h"
#include "tests/bench/peak.h"

#include <benchmark/benchmark.h>

#include <random>
#include <string>

namespace eventide {
namespace {

struct Shape {
    const char* name;
    int side, in, out, stride;
};
/// Sides are those of tiles in the middle of a large map, with what a GRU reads around them.
constexpr Shape kShapes[] = {
    {"in", 36, 21, 8, 1},
    {"gru.0.gates", 34, 16, 16, 1},
    {"gru.0.candidate", 32, 16, 8, 1},
    {"down.1", 24, 8, 16, 2},
    {"down.2", 16, 16, 32, 2},
    {"down.3", 12, 32, 64, 2},
    {"down.4 and res", 12, 64, 64, 1},
    {"up.3", 12, 128, 64, 1},
    {"up.2", 16, 96, 32, 1},
    {"up.1", 24, 48, 16, 1},
    {"up.0", 32, 24, 8, 1},
    {"out", 32, 8, 16, 1},
};

plain::ConvWeights<float> random_weights(int in, int out) {
    std::mt19937 random{1};
    const auto number = [&] { return float(random() % 2001) / 1000 - 1; };
    plain::ConvWeights<float> weights{out, in, {}, {}};
    for (int i = 0; i < 9 * in * out; ++i) weights.weight.push_back(number());
    for (int i = 0; i < out; ++i) weights.bias.push_back(number());
    return weights;
}

void convolve(benchmark::State& state, const Shape& s, const Backend& backend) {
    constexpr int kApart = 3;  // pixels more per row, as in a map larger than the tile
    const int reach = (s.side - 1) * s.stride + 3;
    const PackedConv conv{random_weights(s.in, s.out), s.stride, true, backend, {{s.side, s.side}}};
    Array3<float> in{reach, reach + kApart, s.in}, out{s.side, s.side + kApart, s.out};
    std::mt19937 random{2};
    for (float& v : in.values()) v = float(random() % 2001) / 1000 - 1;
    std::vector<float> scratch(conv.scratch_size(s.side, s.side) + 1);
    const ConvCall call{in.values().data(),
                        std::ptrdiff_t(reach + kApart) * s.in,
                        out.values().data(),
                        std::ptrdiff_t(s.side + kApart) * s.out,
                        s.side,
                        s.side};
    for (auto _ : state) conv.run(call, scratch.data());
    state.counters["GFLOP/s"] = benchmark::Counter(2e-9 * 9 * s.in * s.out * s.side * s.side,
                                                   benchmark::Counter::kIsIterationInvariantRate);
    state.SetLabel(name_of(backend));
}

/// A block of pixels through the renderer's hidden layer.
void linear(benchmark::State& state, const Backend& backend) {
    constexpr int kPixels = 56, kWidth = 32;
    const auto weights = random_weights(kWidth, kWidth);
    const PackedWeights layer{1,
                              1,
                              kWidth,
                              kWidth,
                              {weights.weight.begin(), weights.weight.begin() + kWidth * kWidth},
                              weights.bias,
                              true,
                              backend};
    const std::vector<float> in(kPixels * kWidth, 0.5F);
    std::vector<float> out(kPixels * kWidth);
    for (auto _ : state) {
        layer.run(in.data(), 0, layer.step(), kPixels, out.data(), kWidth);
        benchmark::ClobberMemory();
    }
    state.counters["GFLOP/s"] = benchmark::Counter(2e-9 * kWidth * kWidth * kPixels,
                                                   benchmark::Counter::kIsIterationInvariantRate);
}

int register_all() {
    bench::add_peaks(Instructions::best);
    std::vector<Backend> kinds{{}, {&vector_kernels(Instructions::avx2)}};
    if (onednn_available()) kinds.push_back({.onednn = true});
    const Bf16Kernels* bf16 = bf16_kernels();
    if (bf16 != nullptr) kinds.push_back({.bf16 = bf16});
    if (bf16 != nullptr && onednn_has_bf16()) kinds.push_back({.bf16 = bf16, .onednn = true});
    for (const Shape& s : kShapes)
        for (const Backend& kind : kinds) {
            const std::string name = std::string{s.name} + "/" + std::to_string(s.side) + "px/" +
                                     std::to_string(s.in) + "->" + std::to_string(s.out) +
                                     (kind.bf16 != nullptr ? "/bf16" : "/f32") +
                                     (kind.onednn ? "/onednn" : "/own") + "/" + kind.f32->name;
            benchmark::RegisterBenchmark(name.c_str(), convolve, s, kind)
                ->Unit(benchmark::kMicrosecond)
                ->MinTime(0.1);
        }
    for (const Backend& kind : kinds) {
        if (kind.onednn) continue;
        const char* name =
            kind.bf16 != nullptr ? "renderer, hidden layer/bf16" : "renderer, hidden layer/f32";
        benchmark::RegisterBenchmark(name, linear, kind)
            ->Unit(benchmark::kMicrosecond)
            ->MinTime(0.1);
    }
    return 0;
}
const int kRegistered = register_all();

}  // namespace
}  // namespace eventide
