// Milliseconds per event window (encode) and per frame (render) of the shipped models, on one and
// two threads, beside oneDNN layer by layer and the processor's own peak (`eventide bench --stages`
// has the stages alone, with shares of the peak). Run with OMP_NUM_THREADS=1, so that oneDNN uses
// one thread too; add EVENTIDE_BENCH_AVX2=1 and ONEDNN_MAX_CPU_ISA=AVX2 for the figures of a
// processor without AVX-512.
#include "apps/bench/products.h"
#include "pipeline/parallel_tbb.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"
#include "src/nn/packed_conv.h"
#include "tests/bench/peak.h"
#include "tests/model/streams.h"

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <cstring>
#include <string>

#if EVENTIDE_ONEDNN
#include <oneapi/dnnl/dnnl.hpp>

#include <unordered_map>
#endif

namespace eventide {
namespace {

using Kind = test::GridStream::Kind;
using bench::Layer;

void report(benchmark::State& state, double products) {
    state.counters["GFLOP/s"] =
        benchmark::Counter(2e-9 * products, benchmark::Counter::kIsIterationInvariantRate);
}

struct Setting {
    std::string name;
    Model model;
    int width, height, threads;
    Precision precision;
    Instructions instructions;

    EngineOptions options() const {
        EngineOptions options;
        options.precision = precision;
        options.instructions = instructions;
        options.parallel_for = threads > 1 ? parallel_for_with(threads) : sequential_for;
        return options;
    }
    std::string text() const {
        return name + "/" + std::to_string(width) + "x" + std::to_string(height) +
               (precision == Precision::bf16 ? "/bf16" : "/f32") +
               "/threads:" + std::to_string(threads);
    }
};

void encode(benchmark::State& state, const Setting& s, Kind kind) {
    Encoder encoder{s.model, s.width, s.height, s.options()};
    test::GridStream stream{s.model.config, s.height, s.width, 1};
    LatentMap latent = encoder.make_output();
    encoder.encode(stream.next(Kind::everywhere), latent);
    const VoxelGrid grid = stream.next(kind);
    for (auto _ : state) encoder.encode(grid, latent);
    if (kind == Kind::everywhere)
        report(state, bench::encode_products(s.model.config, s.height, s.width));
    state.SetLabel(encoder.description());
}

/// One frame at the sensor's size. `fresh`: for each frame a new latent map, wholly changed.
void render(benchmark::State& state, const Setting& s, int lookahead, double scale, bool fresh) {
    Renderer renderer{s.model, s.width, s.height, s.options()};
    LatentMap latents[2];
    std::mt19937 random{1};
    for (LatentMap& latent : latents) {
        latent.values = {s.height, s.width, s.model.config.latent};
        for (float& v : latent.values.values()) v = float(random() % 2001) / 1000 - 1;
    }
    std::int64_t k = 0;
    const auto push = [&] {
        LatentMap& latent = latents[k & 1];
        latent.window = {from_us(k * 50'000), from_us((k + 1) * 50'000)};
        renderer.push(latent);
        ++k;
    };
    for (int i = 0; i < 4; ++i) push();
    RenderRequest request;
    request.width = int(s.width * scale);
    request.height = int(s.height * scale);
    request.lookahead = lookahead;
    Frame frame = renderer.make_output(request);
    for (auto _ : state) {
        if (fresh) push();
        request.t = from_us((k - lookahead) * 50'000 - 20'000);
        renderer.render(request, frame);
    }
}

#if EVENTIDE_ONEDNN
/// What the same convolutions cost when each is one oneDNN call on whole images, and nothing else
/// is done: no gates, no joining, no up-sampling.
void onednn(benchmark::State& state, const Setting& s) {
    using namespace dnnl;
    const engine cpu{engine::kind::cpu, 0};
    stream queue{cpu};
    const auto type =
        s.precision == Precision::bf16 ? memory::data_type::bf16 : memory::data_type::f32;
    struct Call {
        convolution_forward primitive;
        std::unordered_map<int, memory> arguments;
    };
    std::vector<Call> calls;
    const auto layers = bench::encoder_layers(s.model.config, s.height, s.width);
    for (const Layer& l : layers) {
        const int h = (l.height + l.stride - 1) / l.stride, w = (l.width + l.stride - 1) / l.stride;
        const memory::desc in{{1, l.in, l.height, l.width}, type, memory::format_tag::nhwc};
        const memory::desc weight{{l.out, l.in, 3, 3}, type, memory::format_tag::any};
        const memory::desc bias{{l.out}, memory::data_type::f32, memory::format_tag::x};
        const memory::desc out{{1, l.out, h, w}, memory::data_type::f32, memory::format_tag::nhwc};
        primitive_attr attributes;
        post_ops ops;
        ops.append_eltwise(1, algorithm::eltwise_relu, 0, 0);
        attributes.set_post_ops(ops);
        const int after_y = (h - 1) * l.stride + 2 - l.height;
        const int after_x = (w - 1) * l.stride + 2 - l.width;
        const convolution_forward::primitive_desc description{{prop_kind::forward_inference,
                                                               algorithm::convolution_direct,
                                                               in,
                                                               weight,
                                                               bias,
                                                               out,
                                                               {l.stride, l.stride},
                                                               {1, 1},
                                                               {after_y, after_x}},
                                                              attributes,
                                                              cpu};
        const memory packed{description.weights_desc(), cpu};
        calls.push_back({convolution_forward{description},
                         {{DNNL_ARG_SRC, memory{in, cpu}},
                          {DNNL_ARG_WEIGHTS, packed},
                          {DNNL_ARG_BIAS, memory{bias, cpu}},
                          {DNNL_ARG_DST, memory{out, cpu}}}});
        for (auto& [which, argument] : calls.back().arguments)
            std::memset(argument.get_data_handle(), 0, argument.get_desc().get_size());
    }
    for (auto _ : state) {
        for (Call& call : calls) call.primitive.execute(queue, call.arguments);
        queue.wait();
    }
    report(state, bench::products_of(layers));
}
#endif

template <typename... Arguments>
void add(const std::string& name, Arguments... arguments) {
    benchmark::RegisterBenchmark(name.c_str(), arguments...)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->MinTime(0.3);
}

Model shipped(const std::string& name) {
    return load_model(EVENTIDE_SOURCE_DIR "/config/models/" + name + ".safetensors");
}

int register_all() {
    const bool is_avx2 = std::getenv("EVENTIDE_BENCH_AVX2") != nullptr;
    const Instructions most = is_avx2 ? Instructions::avx2 : Instructions::best;
    bench::add_peaks(most);
    for (const auto& [width, height] :
         std::vector<std::pair<int, int>>{{240, 180}, {346, 260}, {640, 480}, {1280, 720}})
        for (const std::string name : {"default", "small", "thesis"})
            for (const Precision precision : {Precision::f32, Precision::bf16}) {
                if (precision == Precision::bf16 && bf16_kernels(most) == nullptr) continue;
                for (const int threads : {1, 2}) {
                    const Setting s{name, shipped(name), width, height, threads, precision, most};
                    add("encode/" + s.text(), encode, s, Kind::everywhere);
                    if (name != "thesis") {
                        add("encode_patch/" + s.text(), encode, s, Kind::patch);
                        add("encode_silence/" + s.text(), encode, s, Kind::silence);
                    }
                    add("render/lookahead:0/" + s.text(), render, s, 0, 1.0, false);
                    add("render/lookahead:0/fresh/" + s.text(), render, s, 0, 1.0, true);
                    add("render/lookahead:2/" + s.text(), render, s, 2, 1.0, false);
                    if (width <= 346)
                        add("render/lookahead:0/2.5x/" + s.text(), render, s, 0, 2.5, false);
#if EVENTIDE_ONEDNN
                    if (threads == 1) add("onednn_layers/" + s.text(), onednn, s);
#endif
                }
            }
    return 0;
}
const int kRegistered = register_all();

}  // namespace
}  // namespace eventide
