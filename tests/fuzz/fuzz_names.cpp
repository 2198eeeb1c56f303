// Any text as the name of a source or a sink, and as the settings with a language of their own that
// are read where they are needed: refused as wrong usage, or what is written of it means the same.
#include "apps/cli/settings/sink_name.h"
#include "drivers/ros2/ros2_source_name.h"
#include "drivers/simulated/simulated_name.h"
#include "pipeline/ros2/ros2_name.h"
#include "src/binning/flicker_pairs.h"
#include "src/binning/noise_filter.h"
#include "src/binning/slicer_settings.h"
#include "src/core/error.h"
#include "src/io/udp_socket.h"
#include "tests/fuzz/fuzz_file.h"

namespace {

using namespace eventide;

void require(bool holds) {
    if (!holds) std::abort();
}

/// read(text) gives what `text` means, as a text.
template <typename Read>
void read_twice(const std::string& text, Read read) {
    std::string once;
    try {
        once = read(text);
    } catch (const Error& error) {
        require(error.kind() == ErrorKind::usage);
        return;
    }
    require(read(once) == once);
}

template <typename Read>
void read_once(const std::string& text, Read read) {
    try {
        read(text);
    } catch (const Error& error) {
        require(error.kind() == ErrorKind::usage);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text{text_of_input(data, size)};
    read_twice(text, [](const std::string& given) { return window_text(parse_window(given)); });
    for (const bool models : {false, true})
        read_twice(text, [models](const std::string& given) {
            const auto noise = parse_noise_filter(given, models);
            return noise ? noise_filter_text(*noise) : "off";
        });
    read_twice(text, [](const std::string& given) {
        const std::string name = UdpName::parse(given).text();
        return name.substr(name.find(':') + 1);
    });
    read_once(text, [](const std::string& given) { parse_lamp_flicker(given, true); });
    read_once(text, parse_simulated_name);
    read_once(text, parse_ros2_source_name);
    read_once(text, parse_ros2_sink_name);
    read_once(text, app::parse_sink);
    return 0;
}
