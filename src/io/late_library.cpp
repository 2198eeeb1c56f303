// Libraries by dlopen().
#include "src/io/late_library.h"

#include "src/core/error.h"
#include "src/io/system_words.h"

#include <dlfcn.h>

#include <cerrno>
#include <string>

namespace eventide {

LateLibrary::LateLibrary(const char* soname, const char* needed_for, const char* package)
    : soname_{soname}, library_{dlopen(soname, RTLD_LAZY | RTLD_LOCAL)} {
    if (library_ == nullptr)
        throw Error(
            ErrorKind::failed,
            std::string{needed_for} + ": " +
                (out_of_descriptors(1) ? system_words(EMFILE)
                                       // glibc keeps a message for each thread.
                                       : std::string{dlerror()} +  // NOLINT(concurrency-mt-unsafe)
                                             "; Debian's package is " + package));
}

void* LateLibrary::address_of(const char* name) const {
    void* found = dlsym(library_, name);
    if (found == nullptr)
        throw Error(ErrorKind::failed,
                    std::string{soname_} + ": expected " + name + ", found a library without it");
    return found;
}

}  // namespace eventide
