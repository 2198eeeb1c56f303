// Libraries by dlopen().
#include "src/io/late_library.h"

#include "src/core/error.h"

#include <dlfcn.h>

#include <string>

namespace eventide {

LateLibrary::LateLibrary(const char* soname, const char* needed_for, const char* package)
    : soname_{soname}, library_{dlopen(soname, RTLD_LAZY | RTLD_LOCAL)} {
    if (library_ == nullptr)
        throw Error(ErrorKind::failed, std::string{needed_for} + ": " + dlerror() +
                                           "; Debian's package is " + package);
}

void* LateLibrary::address_of(const char* name) const {
    void* found = dlsym(library_, name);
    if (found == nullptr)
        throw Error(ErrorKind::failed,
                    std::string{soname_} + ": expected " + name + ", found a library without it");
    return found;
}

}  // namespace eventide
