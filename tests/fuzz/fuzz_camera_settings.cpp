// Any bytes as the settings of each kind of camera: refused with words, or such as can be sent to
// one.
#include "drivers/usb/davis_settings.h"
#include "drivers/usb/dvs128_camera.h"
#include "drivers/usb/dvxplorer_settings.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

namespace {

/// use(file) reads it as one kind.
template <typename Use>
void read(const std::string& file, Use use) {
    using namespace eventide;
    try {
        use(file);
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::usage) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    read(file.path(), [](const std::string& name) { run_writes(load_davis_settings(name)); });
    read(file.path(), [](const std::string& name) {
        for (const bool mini : {false, true})
            dvxplorer_run_writes(load_dvxplorer_settings(name), mini);
    });
    read(file.path(), [](const std::string& name) { bias_bytes(load_dvs128_settings(name)); });
    return 0;
}
