// Any bytes as an .npy and as an .npz file with events.
#include "replay/numpy/numpy_recording.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    for (const auto open : {open_npy, open_npz}) try {
            const auto reader = open(file.path(), {});
            Batch batch;
            Damage damage;
            while (reader->read(batch, damage)) batch.clear();
            reader->seek(from_us(100));
            reader->read(batch, damage);
        } catch (const Error&) {
        }
    return 0;
}
