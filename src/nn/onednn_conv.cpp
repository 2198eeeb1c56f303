// See onednn_conv.h.
#include "src/nn/onednn_conv.h"

#include "src/core/array.h"
#include "src/core/error.h"

#if EVENTIDE_ONEDNN

#include "src/kernels/bf16_kernels.h"

#include <sys/mman.h>
#include <oneapi/dnnl/dnnl.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <new>
#include <utility>

// Debian's oneDNN divides its work among OpenMP's threads, as many as OpenMP has been told on the
// calling thread. These two are OpenMP's own; declared here because clang has no <omp.h> of its
// own.
extern "C" {
int omp_get_max_threads();
void omp_set_num_threads(int n);
}

namespace eventide {
namespace {

using dnnl::memory;

/// While it lives, oneDNN works on this thread alone; whoever else uses OpenMP here finds it as it
/// was.
class OneThread {
public:
    OneThread() : before_(omp_get_max_threads()) {
        if (before_ != 1) omp_set_num_threads(1);
    }
    ~OneThread() {
        if (before_ != 1) omp_set_num_threads(before_);
    }
    OneThread(const OneThread&) = delete;
    OneThread& operator=(const OneThread&) = delete;

private:
    int before_;
};

const dnnl::engine& processor() {
    static const dnnl::engine engine{dnnl::engine::kind::cpu, 0};
    return engine;
}

constexpr std::size_t kLine = 64;  // bytes; what oneDNN likes its memory aligned to

std::size_t in_lines(std::size_t bytes) {
    return (bytes + kLine - 1) / kLine * kLine;
}

/// Cuts scratch memory into aligned pieces.
///
///     | up to 63 bytes | input, where it is gathered here | output | oneDNN's scratchpad |
class Pieces {
public:
    explicit Pieces(float* scratch) : at_(reinterpret_cast<std::byte*>(scratch)) {
        const auto address = reinterpret_cast<std::uintptr_t>(scratch);
        at_ += in_lines(address) - address;
    }
    void* take(std::size_t bytes) { return std::exchange(at_, at_ + in_lines(bytes)); }

private:
    std::byte* at_;
};

bool is_at_least(dnnl::cpu_isa isa) {
    // The instruction sets' numbers are sets of bits, each holding its forerunners'.
    const auto mine = unsigned(dnnl::get_effective_cpu_isa()), asked = unsigned(isa);
    return (mine & asked) == asked;
}

dnnl::primitive_attr attributes(bool relu) {
    dnnl::primitive_attr attributes;
    attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);
    if (relu) {
        dnnl::post_ops after;
        after.append_eltwise(1, dnnl::algorithm::eltwise_relu, 0, 0);
        attributes.set_post_ops(after);
    }
    return attributes;
}

}  // namespace

bool onednn_available() {
    return true;
}
bool onednn_has_bf16() {
    return is_at_least(dnnl::cpu_isa::avx512_core_bf16);
}
bool onednn_has_amx() {
    return is_at_least(dnnl::cpu_isa::avx512_core_amx);
}

struct OnednnConv::Primitives {
    struct Sized {
        Extent extent;
        dnnl::convolution_forward primitive;
        memory::desc in, out, scratchpad;
        memory weights;
        std::size_t scratch_bytes = 0;
    };

    int channels = 0, outputs = 0, stride = 1;
    const Bf16Kernels* bf16 = nullptr;  // null: float32
    memory bias;
    std::vector<Sized> sized;

    Extent reach(Extent e) const {
        return {(e.height - 1) * stride + 3, (e.width - 1) * stride + 3};
    }
    void add(Extent extent, bool relu, const memory& plain_weights);
    const Sized& of(Extent extent) const;
    const void* gather(const ConvCall& call, void* dense) const noexcept;
};

/// oneDNN does not look whether there was memory for the code it makes, and dies writing it: that
/// there is some is found out before.
void expect_room() {
    constexpr std::size_t kRoom = std::size_t{16} << 20;
    void* const room =
        ::mmap(nullptr, kRoom, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (room == MAP_FAILED) throw std::bad_alloc{};
    ::munmap(room, kRoom);
}

void OnednnConv::Primitives::add(Extent extent, bool relu, const memory& plain_weights) {
    expect_room();
    const auto [rows, columns] = reach(extent);
    const auto type = bf16 != nullptr ? memory::data_type::bf16 : memory::data_type::f32;
    Sized& made = sized.emplace_back();
    made.extent = extent;
    made.in = {{1, channels, rows, columns}, type, memory::format_tag::nhwc};
    made.out = {{1, outputs, extent.height, extent.width},
                memory::data_type::f32,
                memory::format_tag::nhwc};
    const dnnl::convolution_forward::primitive_desc description{
        {dnnl::prop_kind::forward_inference,
         dnnl::algorithm::convolution_direct,
         made.in,
         {{outputs, channels, 3, 3}, type, memory::format_tag::any},
         bias.get_desc(),
         made.out,
         {stride, stride},
         {0, 0},
         {0, 0}},
        attributes(relu),
        processor()};
    made.primitive = dnnl::convolution_forward{description};
    made.scratchpad = description.scratchpad_desc();
    // Primitives that want the weights in the same order share them.
    const auto same = std::ranges::find_if(sized, [&](const Sized& other) {
        return &other != &made && other.weights.get_desc() == description.weights_desc();
    });
    if (same != sized.end()) {
        made.weights = same->weights;
    } else {
        made.weights = memory{description.weights_desc(), processor()};
        dnnl::stream stream{processor()};
        dnnl::reorder{plain_weights, made.weights}.execute(
            stream, const_cast<memory&>(plain_weights), made.weights);
        stream.wait();
    }
    made.scratch_bytes = in_lines(made.in.get_size()) + in_lines(made.out.get_size()) +
                         in_lines(made.scratchpad.get_size()) + kLine;
}

const OnednnConv::Primitives::Sized& OnednnConv::Primitives::of(Extent extent) const {
    const auto found = std::ranges::find(sized, extent, &Sized::extent);
    assert(found != sized.end());
    return *found;
}

/// The call's input as a dense block of the primitive's numbers.
const void* OnednnConv::Primitives::gather(const ConvCall& call, void* dense) const noexcept {
    const auto [rows, columns] = reach({call.height, call.width});
    const auto row = std::ptrdiff_t(columns) * channels;
    if (bf16 == nullptr) {
        if (call.in_pitch == row) return call.in;
        for (int y = 0; y < rows; ++y)
            std::memcpy(static_cast<float*>(dense) + y * row, call.in + y * call.in_pitch,
                        std::size_t(row) * sizeof(float));
        return dense;
    }
    auto* pixels_to_bf16 = static_cast<std::uint16_t*>(dense);
    for (int y = 0; y < rows; ++y)
        bf16->row_to_bf16(call.in + y * call.in_pitch, std::size_t(row), pixels_to_bf16 + y * row);
    return dense;
}

OnednnConv::OnednnConv(const plain::ConvWeights<float>& weights, int stride, bool relu,
                       const Bf16Kernels* bf16, std::vector<Extent> extents) {
    const OneThread one_thread;
    auto made = std::make_unique<Primitives>();
    made->channels = weights.in;
    made->outputs = weights.out;
    made->stride = stride;
    made->bf16 = bf16;
    made->bias =
        memory{{{weights.out}, memory::data_type::f32, memory::format_tag::x}, processor()};
    std::ranges::copy(weights.bias, static_cast<float*>(made->bias.get_data_handle()));
    std::vector<float> values = weights.weight;
    const memory plain_weights{
        {{weights.out, weights.in, 3, 3}, memory::data_type::f32, memory::format_tag::oihw},
        processor(),
        values.data()};
    std::ranges::sort(extents, {}, [](Extent e) { return std::pair{e.height, e.width}; });
    extents.erase(std::unique(extents.begin(), extents.end()), extents.end());
    for (const Extent extent : extents) made->add(extent, relu, plain_weights);
    primitives_ = std::move(made);
}

OnednnConv::~OnednnConv() = default;

std::size_t OnednnConv::scratch_size() const {
    std::size_t bytes = 0;
    for (const Primitives::Sized& sized : primitives_->sized)
        bytes = std::max(bytes, sized.scratch_bytes);
    return bytes / sizeof(float);
}

// Only memory can run out, which ends the program here as anywhere else.
// NOLINTNEXTLINE(bugprone-exception-escape)
void OnednnConv::run(const ConvCall& call, float* scratch) const noexcept {
    const Primitives& p = *primitives_;
    const Primitives::Sized& sized = p.of({call.height, call.width});
    Pieces pieces{scratch};
    void* in = const_cast<void*>(call.gathered);
    if (in == nullptr) in = const_cast<void*>(p.gather(call, pieces.take(sized.in.get_size())));
    const std::ptrdiff_t row = std::ptrdiff_t(call.width) * p.outputs;
    const bool dense = call.out_pitch == row;
    auto* out = static_cast<float*>(pieces.take(sized.out.get_size()));
    if (dense) out = call.out;

    const memory from{sized.in, processor(), in}, to{sized.out, processor(), out};
    const memory room{sized.scratchpad, processor(), pieces.take(sized.scratchpad.get_size())};
    const std::array<dnnl_exec_arg_t, 5> arguments{{{DNNL_ARG_SRC, from.get()},
                                                    {DNNL_ARG_WEIGHTS, sized.weights.get()},
                                                    {DNNL_ARG_BIAS, p.bias.get()},
                                                    {DNNL_ARG_DST, to.get()},
                                                    {DNNL_ARG_SCRATCHPAD, room.get()}}};
    {
        const OneThread one_thread;
        thread_local const dnnl::stream stream{processor()};
        dnnl::error::wrap_c_api(dnnl_primitive_execute(sized.primitive.get(), stream.get(),
                                                       int(arguments.size()), arguments.data()),
                                "oneDNN could not run a convolution");
    }
    if (dense) return;
    for (int y = 0; y < call.height; ++y, out += row)
        std::memcpy(call.out + y * call.out_pitch, out, std::size_t(row) * sizeof(float));
}

}  // namespace eventide

#else

namespace eventide {

bool onednn_available() {
    return false;
}
bool onednn_has_bf16() {
    return false;
}
bool onednn_has_amx() {
    return false;
}

struct OnednnConv::Primitives {};
OnednnConv::OnednnConv(const plain::ConvWeights<float>&, int, bool, const Bf16Kernels*,
                       std::vector<Extent>) {
    throw Error(ErrorKind::usage,
                "kernels onednn: expected a program built with EVENTIDE_ONEDNN, found one without");
}
OnednnConv::~OnednnConv() = default;
std::size_t OnednnConv::scratch_size() const {
    return 0;
}
void OnednnConv::run(const ConvCall&, float*) const noexcept {}

}  // namespace eventide

#endif
