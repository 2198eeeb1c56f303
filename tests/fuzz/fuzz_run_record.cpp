// Any bytes as the record in a folder that is to be written again: refused, or an earlier run's.
// The folder holds a file of each kind, and one that is nobody's.
#include "pipeline/sinks/folder.h"
#include "pipeline/sinks/run_folder.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;

/// In memory, and gone with the process.
struct Folder {
    Folder() : path("/dev/shm/eventide_fuzz_" + std::to_string(::getpid())) {
        for (const char* file :
             {"frames/frame_0000000000.png", "frames/frame_0000000002.png",
              "uncertainty/unc_0000000000.tiff", "timestamps.txt", "timestamps.csv", "notes.txt"}) {
            fs::create_directories((path / file).parent_path());
            std::ofstream{path / file} << "one\ntwo\n";
        }
    }
    ~Folder() { fs::remove_all(path); }
    fs::path path;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static const Folder folder;
    std::ofstream{folder.path / kRunRecord, std::ios::binary} << text_of_input(data, size);
    try {
        const RunFolder again{folder.path, true, FolderSink::files()};
        if (!again.holds_earlier_run()) std::abort();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::usage) std::abort();
    }
    return 0;
}
