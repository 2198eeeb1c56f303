// For the build: the manual page or the completion that is installed beside the program.
#include "apps/cli/program.h"

#include <cstdio>
#include <string>

int main(int argc, char** argv) {
    const std::string what = argc == 2 ? argv[1] : "";
    if (what != "page" && what != "bash") {
        std::fprintf(stderr, "print_manual: expected page or bash, found '%s'\n", what.c_str());
        return 2;
    }
    const std::string text =
        what == "page" ? eventide::app::manual_page() : eventide::app::bash_completion();
    return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() ? 0 : 1;
}
