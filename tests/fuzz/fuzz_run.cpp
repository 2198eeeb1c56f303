// eventide run as a whole, of any bytes, with the tiniest network and sensor: four threads, frames,
// sigma. A sensor of any size is for the target recording: here every pixel costs time.
#include "apps/cli/program.h"
#include "apps/cli/signals.h"
#include "tests/fuzz/fuzz_file.h"

#include <iostream>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static app::Signals signals;
    static MemoryFile recording;
    recording.hold(data, size);
    const int code = app::run_program(signals, {"run",
                                                recording.path(),
                                                "--model",
                                                EVENTIDE_FUZZ_MODEL,
                                                "--input-size",
                                                "16x12",
                                                "--out",
                                                "gray8:/dev/null",
                                                "--overwrite",
                                                "--size",
                                                "8x6",
                                                "--fps",
                                                "50",
                                                "--precision",
                                                "f32",
                                                "--duration",
                                                "100ms",
                                                "--threads",
                                                "1",
                                                "--quiet",
                                                "--log-level",
                                                "off"});
    if (code != 0 && code != 1 && code != 2 && code != 3) std::abort();
    return 0;
}
