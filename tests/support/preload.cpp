#include "tests/support/preload.h"

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>

namespace eventide::testing_support {
namespace {
constexpr const char* kPreload = "libumockdev-preload.so.0";
// A sanitizer's runtime insists on being the first library.
#ifdef __SANITIZE_ADDRESS__
constexpr const char* kFirst = "libasan.so.8:";
#else
constexpr const char* kFirst = "";
#endif
}  // namespace

bool runs_in_testbed() {
    const char* preload = std::getenv("LD_PRELOAD");
    return preload != nullptr && std::strstr(preload, kPreload) != nullptr;
}

void enter_testbed(char** argv) {
    if (runs_in_testbed()) return;
    const char* before = std::getenv("LD_PRELOAD");
    const std::string preload =
        std::string{kFirst} + kPreload + (before ? std::string{":"} + before : "");
    setenv("LD_PRELOAD", preload.c_str(), 1);
    execv("/proc/self/exe", argv);
}

}  // namespace eventide::testing_support
