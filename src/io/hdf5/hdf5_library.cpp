// The HDF5 library by dlopen().
#include "src/io/hdf5/hdf5_library.h"

#include "src/core/error.h"
#include "src/io/late_library.h"

#include <dlfcn.h>

#include <string>

namespace eventide {

namespace {

/// Set by H5open(). Of a program that is linked with the library these variables may lie in the
/// program.
hid_t find_id(const LateLibrary& library, const char* name) {
    const hid_t* own_id = nullptr;
    library.find(own_id, name);
    const hid_t own = *own_id;
    const void* elsewhere = own > 0 ? nullptr : dlsym(RTLD_DEFAULT, name);
    return elsewhere == nullptr ? own : *static_cast<const hid_t*>(elsewhere);
}

Hdf5Library load() {
    const LateLibrary library{EVENTIDE_HDF5_LIBRARY, "HDF5 files need the HDF5 library",
                              "libhdf5-103-1"};
    Hdf5Library h5;
#define EVENTIDE_HDF5_FIND(name) library.find(h5.name, #name);
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
