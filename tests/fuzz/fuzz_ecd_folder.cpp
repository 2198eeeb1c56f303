// A folder of the Event Camera Dataset: any images.txt, events.txt and exposure.txt, with a record
// separator (0x1E) between them.
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;

/// In memory, and gone with the process.
struct Folder {
    Folder() : path("/dev/shm/eventide_fuzz_" + std::to_string(::getpid())) {
        fs::create_directories(path / "images");
        // 2 x 1 pixels of 8 bit grey.
        std::ofstream{path / "images/a.pgm", std::ios::binary} << "P5 2 1 255\n\x10\x20";
    }
    ~Folder() { fs::remove_all(path); }
    void hold(const char* name, std::string_view bytes) const {
        std::ofstream{path / name, std::ios::binary} << bytes;
    }
    fs::path path;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static const Folder folder;
    std::string_view rest = text_of_input(data, size);
    for (const char* file : {"images.txt", "events.txt", "exposure.txt"})
        folder.hold(file, take_until(rest, '\x1E'));
    try {
        summarize(*open_recording(folder.path.string()));
    } catch (const Error&) {
    }
    return 0;
}
