// Any bytes as a file of biases, as lines or as JSON: refused with words, or values that a sensor's
// control can have.
#include "drivers/v4l2/bias_file.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace {

/// The same bytes under another name: the extension says what is in them.
class Link {
public:
    Link(const std::string& file, const char* extension) : name{file + extension} {
        std::filesystem::create_symlink(file, name);
    }
    ~Link() { std::filesystem::remove(name); }
    Link(const Link&) = delete;
    Link& operator=(const Link&) = delete;

    const std::filesystem::path name;
};

void read(const std::filesystem::path& name) {
    using namespace eventide;
    try {
        for (const BiasLine& bias : read_bias_file(name))
            if (bias.name.empty() || bias.value > INT32_MAX || bias.value < INT32_MIN) std::abort();
    } catch (const Error& error) {
        // A piece of it, not the file.
        if (error.kind() != ErrorKind::usage || std::string_view{error.what()}.size() > 1000)
            std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static eventide::MemoryFile file;
    static const Link lines{file.path(), ".bias"}, json{file.path(), ".json"};
    file.hold(data, size);
    read(lines.name);
    read(json.name);
    return 0;
}
