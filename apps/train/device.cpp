#include "apps/train/device.h"

#include "src/core/error.h"

#include <ctime>

namespace eventide {
namespace {

bool processor_has_bf16() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx512bf16") != 0;
#else
    return false;
#endif
}

}  // namespace

torch::Device device_of(const TrainOptions& options) {
    if (options.device != "cpu" && options.device != "cuda")
        throw Error(ErrorKind::usage,
                    "--device: expected cpu or cuda, found '" + options.device + "'");
    if (options.device == "cuda" && !torch::cuda::is_available())
        throw Error(ErrorKind::device, "--device cuda: this libtorch sees no CUDA device");
    return torch::Device{options.device};
}

torch::ScalarType arithmetic_type(const TrainOptions& options) {
    const bool bf16 = options.precision == Precision::automatic
                          ? options.device == "cuda" || processor_has_bf16()
                          : options.precision == Precision::bf16;
    return bf16 ? torch::kBFloat16 : torch::kFloat;
}

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

}  // namespace eventide
