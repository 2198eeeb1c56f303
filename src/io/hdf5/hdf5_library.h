// The HDF5 library, loaded when the first of its files is opened: who has none does not wait for
// it.
#pragma once

#include <hdf5.h>

#include <mutex>

namespace eventide {

// What is used of it.
#define EVENTIDE_HDF5_FUNCTIONS(X)  \
    X(H5open)                       \
    X(H5Eset_auto2)                 \
    X(H5Aclose)                     \
    X(H5Acreate2)                   \
    X(H5Aexists)                    \
    X(H5Aget_space)                 \
    X(H5Aget_type)                  \
    X(H5Aopen)                      \
    X(H5Aread)                      \
    X(H5Awrite)                     \
    X(H5Dclose)                     \
    X(H5Dcreate2)                   \
    X(H5Dget_create_plist)          \
    X(H5Dget_space)                 \
    X(H5Dget_storage_size)          \
    X(H5Dget_type)                  \
    X(H5Dopen2)                     \
    X(H5Dread)                      \
    X(H5Dset_extent)                \
    X(H5Dwrite)                     \
    X(H5Fclose)                     \
    X(H5Fcreate)                    \
    X(H5Fflush)                     \
    X(H5Fget_name)                  \
    X(H5Fopen)                      \
    X(H5free_memory)                \
    X(H5Gclose)                     \
    X(H5Gcreate2)                   \
    X(H5Gget_info)                  \
    X(H5Gopen2)                     \
    X(H5Lexists)                    \
    X(H5Lget_name_by_idx)           \
    X(H5Oexists_by_name)            \
    X(H5Pclose)                     \
    X(H5Pcreate)                    \
    X(H5Pget_chunk)                 \
    X(H5Pget_external_count)        \
    X(H5Pget_filter2)               \
    X(H5Pget_layout)                \
    X(H5Pget_nfilters)              \
    X(H5Pset_buffer)                \
    X(H5Pset_chunk)                 \
    X(H5Pset_chunk_cache)           \
    X(H5Pset_deflate)               \
    X(H5Pset_libver_bounds)         \
    X(H5Pset_shuffle)               \
    X(H5Sclose)                     \
    X(H5Screate)                    \
    X(H5Screate_simple)             \
    X(H5Sget_simple_extent_dims)    \
    X(H5Sget_simple_extent_ndims)   \
    X(H5Sget_simple_extent_npoints) \
    X(H5Sselect_hyperslab)          \
    X(H5Tclose)                     \
    X(H5Tcopy)                      \
    X(H5Tcreate)                    \
    X(H5Tget_class)                 \
    X(H5Tget_member_index)          \
    X(H5Tget_size)                  \
    X(H5Tinsert)                    \
    X(H5Tis_variable_str)           \
    X(H5Tset_size)                  \
    X(H5Zfilter_avail)

// Kinds of numbers and of property lists: variables of the library's.
#define EVENTIDE_HDF5_IDS(X)       \
    X(H5T_NATIVE_DOUBLE_g)         \
    X(H5T_NATIVE_INT8_g)           \
    X(H5T_NATIVE_INT32_g)          \
    X(H5T_NATIVE_INT64_g)          \
    X(H5T_NATIVE_UINT8_g)          \
    X(H5T_NATIVE_UINT16_g)         \
    X(H5T_NATIVE_UINT64_g)         \
    X(H5T_C_S1_g)                  \
    X(H5P_CLS_DATASET_CREATE_ID_g) \
    X(H5P_CLS_DATASET_ACCESS_ID_g) \
    X(H5P_CLS_DATASET_XFER_ID_g)

/// H5F_ACC_RDONLY and H5F_ACC_TRUNC, which are macros that call the library.
constexpr unsigned kHdf5ReadOnly = 0, kHdf5Replace = 2;

/// Each under its own name.
struct Hdf5Library {
// NOLINTBEGIN(bugprone-macro-parentheses): names of members.
#define EVENTIDE_HDF5_FUNCTION(name) decltype(&::name) name = nullptr;
    EVENTIDE_HDF5_FUNCTIONS(EVENTIDE_HDF5_FUNCTION)
#undef EVENTIDE_HDF5_FUNCTION
#define EVENTIDE_HDF5_ID(name) hid_t name = -1;
    // NOLINTEND(bugprone-macro-parentheses)
    EVENTIDE_HDF5_IDS(EVENTIDE_HDF5_ID)
#undef EVENTIDE_HDF5_ID
};

/// Loads it the first time; from then on it prints nothing. Throws Error (failed) where it is
/// missing, naming the package. Thread: any.
const Hdf5Library& hdf5();

/// Debian's HDF5 is not made for several threads: held during every call.
std::recursive_mutex& hdf5_mutex();

}  // namespace eventide
