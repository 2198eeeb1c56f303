// Which program this is, and what it was built with.
#include "apps/cli/version.h"

#include "pipeline/sinks/video/video.h"

#include <opencv2/core/version.hpp>

#include <fstream>

namespace eventide::app {

std::string version() {
    return EVENTIDE_VERSION;
}

std::string compiler_text() {
#if defined(__clang__)
    return std::string{"clang "} + __clang_version__ + ", " + EVENTIDE_FLAGS;
#else
    return std::string{"g++ "} + __VERSION__ + ", " + EVENTIDE_FLAGS;
#endif
}

std::string version_text() {
    return "eventide " + version() + "\nbuilt with " + compiler_text() + "\nOpenCV " + CV_VERSION +
           ", " + video_library();
}

std::string processor_text() {
    std::ifstream info{"/proc/cpuinfo"};
    std::string name = "unknown processor", flags;
    for (std::string line; std::getline(info, line) && flags.empty();) {
        const std::size_t colon = line.find(": ");
        if (colon == line.npos) continue;
        if (line.starts_with("model name")) name = line.substr(colon + 2);
        if (line.starts_with("flags")) flags = line.substr(colon + 1) + " ";
    }
    std::string known;
    for (const char* flag : {"avx2", "avx512f", "avx512_vnni", "avx512_bf16", "amx_bf16"})
        if (flags.find(std::string{" "} + flag + " ") != flags.npos)
            known += (known.empty() ? "" : " ") + std::string{flag};
    return known.empty() ? name : name + " (" + known + ")";
}

}  // namespace eventide::app
