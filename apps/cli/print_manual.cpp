// For the build: the manual page or a shell's completion, installed beside the program.
#include "apps/cli/program.h"

#include <cstdio>
#include <string>
#include <utility>

int main(int argc, char** argv) {
    using namespace eventide::app;
    const std::string what = argc == 2 ? argv[1] : "";
    for (const auto& [word, text] :
         {std::pair{"page", &manual_page}, std::pair{"bash", &bash_completion},
          std::pair{"zsh", &zsh_completion}, std::pair{"fish", &fish_completion}})
        if (what == word) {
            const std::string made = text();
            return std::fwrite(made.data(), 1, made.size(), stdout) == made.size() ? 0 : 1;
        }
    std::fprintf(stderr, "print_manual: expected page, bash, zsh or fish, found '%s'\n",
                 what.c_str());
    return 2;
}
