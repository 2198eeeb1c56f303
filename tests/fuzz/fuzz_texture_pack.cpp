// Any bytes as a pack of textures: refused with words, or images.
#include "src/core/error.h"
#include "src/simulate/scene/texture_pack.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    try {
        for (const GreyImage& image : read_texture_pack(file.path()))
            if (image.width() < 2 || image.height() < 2) std::abort();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::input) std::abort();
    }
    return 0;
}
