// Any bytes as a calibration of a camera: refused with words, or numbers that are finite.
#include "pipeline/calibration/calibration.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

#include <cmath>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    try {
        const Calibration calibration =
            fitted(read_calibration(file.path(), {}), {640, 480, 3, 5, Flip::both}, 100, 90);
        for (const double value : calibration.k)
            if (std::isnan(value)) std::abort();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::input) std::abort();
    }
    return 0;
}
