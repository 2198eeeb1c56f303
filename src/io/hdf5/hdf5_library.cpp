// The HDF5 library by dlopen().
#include "src/io/hdf5/hdf5_library.h"

#include "src/core/error.h"

#include <dlfcn.h>

#include <string>

namespace eventide {

namespace {

void* find(void* library, const char* name) {
    void* found = dlsym(library, name);
    if (found == nullptr)
        throw Error(ErrorKind::failed, std::string{EVENTIDE_HDF5_LIBRARY} +
                                           ": expected HDF5 1.10, found one without " + name);
    return found;
}

/// Set by H5open(). Of a program that is linked with the library these variables may lie in the
/// program.
hid_t find_id(void* library, const char* name) {
    const hid_t own = *static_cast<const hid_t*>(find(library, name));
    const void* elsewhere = own > 0 ? nullptr : dlsym(RTLD_DEFAULT, name);
    return elsewhere == nullptr ? own : *static_cast<const hid_t*>(elsewhere);
}

Hdf5Library load() {
    void* library = dlopen(EVENTIDE_HDF5_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
        throw Error(ErrorKind::failed,
                    "HDF5 files need the HDF5 library: " + std::string{dlerror()} +
                        "; Debian's package is libhdf5-103-1");
    Hdf5Library h5;
#define EVENTIDE_HDF5_FIND(name) \
    h5.name = reinterpret_cast<decltype(h5.name)>(find(library, #name));
    EVENTIDE_HDF5_FUNCTIONS(EVENTIDE_HDF5_FIND)
#undef EVENTIDE_HDF5_FIND
    if (h5.H5open() < 0)
        throw Error(ErrorKind::failed,
                    std::string{EVENTIDE_HDF5_LIBRARY} + ": the HDF5 library does not start");
#define EVENTIDE_HDF5_FIND(name) h5.name = find_id(library, #name);
    EVENTIDE_HDF5_IDS(EVENTIDE_HDF5_FIND)
#undef EVENTIDE_HDF5_FIND
    return h5;
}

}  // namespace

std::recursive_mutex& hdf5_mutex() {
    static std::recursive_mutex mutex;
    return mutex;
}

const Hdf5Library& hdf5() {
    const std::lock_guard lock{hdf5_mutex()};
    static const Hdf5Library library = load();
    // What a thread-safe HDF5 prints by itself it is told for each thread.
    thread_local const bool is_silent = [] {
        library.H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
        return true;
    }();
    static_cast<void>(is_silent);
    return library;
}

}  // namespace eventide
