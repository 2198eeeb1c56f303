// Data sets of an HDF5 file by hyperslabs.
#include "src/io/hdf5/hdf5_data.h"

#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/io/hdf5/hdf5_filters.h"
#include "src/io/hdf5/hdf5_library.h"

#include <limits.h>
#include <algorithm>
#include <functional>
#include <mutex>
#include <numeric>
#include <type_traits>

namespace eventide {

static_assert(sizeof(hsize_t) == sizeof(std::uint64_t));

namespace {

using Lock = std::lock_guard<std::recursive_mutex>;

hid_t open_set(hid_t file, const std::string& name, std::uint64_t cache_bytes) {
    const Hdf5Library& h5 = hdf5();
    const Hdf5Handle access{h5.H5Pcreate(h5.H5P_CLS_DATASET_ACCESS_ID_g), h5.H5Pclose};
    h5.H5Pset_chunk_cache(access.id(), 521, std::size_t(cache_bytes), 1);
    return h5.H5Dopen2(file, name.c_str(), access.id());
}

/// For reading so many bytes: HDF5 would clear twice 1 MiB for the conversion of one number.
Hdf5Handle transfer_of(std::uint64_t bytes) {
    constexpr std::uint64_t kUsualBuffer = std::uint64_t{1} << 20;
    const Hdf5Library& h5 = hdf5();
    Hdf5Handle transfer{h5.H5Pcreate(h5.H5P_CLS_DATASET_XFER_ID_g), h5.H5Pclose};
    if (bytes < kUsualBuffer) h5.H5Pset_buffer(transfer.id(), std::size_t(bytes), nullptr, nullptr);
    return transfer;
}

Hdf5Data::Kind kind_of(hid_t type) {
    switch (hdf5().H5Tget_class(type)) {
        case H5T_INTEGER:
        case H5T_ENUM:  // h5py's booleans
            return Hdf5Data::Kind::integer;
        case H5T_FLOAT:
            return Hdf5Data::Kind::floating;
        case H5T_COMPOUND:
            return Hdf5Data::Kind::record;
        default:
            return Hdf5Data::Kind::other;
    }
}

template <typename T>
hid_t native_kind() {
    const Hdf5Library& h5 = hdf5();
    if constexpr (std::is_same_v<T, double>) return h5.H5T_NATIVE_DOUBLE_g;
    if constexpr (std::is_same_v<T, std::int32_t>) return h5.H5T_NATIVE_INT32_g;
    if constexpr (std::is_same_v<T, std::int64_t>) return h5.H5T_NATIVE_INT64_g;
    if constexpr (std::is_same_v<T, std::uint8_t>) return h5.H5T_NATIVE_UINT8_g;
    if constexpr (std::is_same_v<T, std::uint16_t>) return h5.H5T_NATIVE_UINT16_g;
    return -1;
}

std::string file_of(hid_t object) {
    std::string name(PATH_MAX, '\0');
    hdf5().H5Fget_name(object, name.data(), name.size());
    return name.substr(0, name.find('\0'));
}

}  // namespace

void Hdf5Data::open(std::int64_t file, const std::string& path) {
    const Lock lock{hdf5_mutex()};
    const Hdf5Library& h5 = hdf5();
    constexpr std::uint64_t kUsualCache = std::uint64_t{1} << 20;
    set_ = {open_set(file, path, kUsualCache), h5.H5Dclose};
    space_ = {set_.good() ? h5.H5Dget_space(set_.id()) : -1, h5.H5Sclose};
    if (!space_.good()) refuse("a data set", "something else");
    type_ = {h5.H5Dget_type(set_.id()), h5.H5Tclose};
    plan_ = {h5.H5Dget_create_plist(set_.id()), h5.H5Pclose};
    kind_ = kind_of(type_.id());
    shape_.resize(std::size_t(std::max(0, h5.H5Sget_simple_extent_ndims(space_.id()))));
    h5.H5Sget_simple_extent_dims(space_.id(), reinterpret_cast<hsize_t*>(shape_.data()), nullptr);
    check_place(file);
    check_filters(name_, plan_.id());
    check_blocks();
    if (!shape_.empty()) check_stored();
    // A block that does not fit the cache would be unpacked anew for each part of it.
    if (block_bytes() > kUsualCache) set_ = {open_set(file, path, block_bytes()), h5.H5Dclose};
}

void Hdf5Data::refuse(const std::string& expected, const std::string& what) const {
    throw Error(ErrorKind::input, name_ + ": expected " + expected + ", found " + what);
}

std::string Hdf5Data::shape_text() const {
    return "[" + list_of(shape_, [](std::uint64_t n) { return std::to_string(n); }) + "]";
}

std::uint64_t Hdf5Data::row_length() const {
    return shape_.empty() ? 1
                          : std::accumulate(shape_.begin() + 1, shape_.end(), std::uint64_t{1},
                                            std::multiplies{});
}

bool Hdf5Data::has_member(const std::string& member) const {
    const Lock lock{hdf5_mutex()};
    return kind_ == Kind::record && hdf5().H5Tget_member_index(type_.id(), member.c_str()) >= 0;
}

bool Hdf5Data::is_narrow() const {
    const Lock lock{hdf5_mutex()};
    return hdf5().H5Tget_size(type_.id()) == 1;
}

/// Of one of its blocks, unpacked; 0 where it has none.
std::uint64_t Hdf5Data::block_bytes() const {
    const Hdf5Library& h5 = hdf5();
    if (h5.H5Pget_layout(plan_.id()) != H5D_CHUNKED) return 0;
    std::vector<hsize_t> sides(std::max<std::size_t>(shape_.size(), 1), 1);
    h5.H5Pget_chunk(plan_.id(), int(shape_.size()), sides.data());
    std::uint64_t bytes = h5.H5Tget_size(type_.id());
    for (const hsize_t side : sides) {
        if (side != 0 && bytes > ~std::uint64_t{0} / side) return ~std::uint64_t{0};
        bytes *= side;
    }
    return bytes;
}

void Hdf5Data::check_blocks() const {
    if (const std::uint64_t bytes = block_bytes(); bytes > kLargestBlock)
        refuse("blocks of at most 256 MiB", "blocks of " + std::to_string(bytes) + " bytes");
}

/// In the file itself: what lies in others, which nobody named, might be an output.
void Hdf5Data::check_place(std::int64_t file) const {
    const Hdf5Library& h5 = hdf5();
    const std::string expected = "data in the file itself";
    if (const std::string other = file_of(set_.id()); other != file_of(file))
        refuse(expected, "a link to " + other);
    if (h5.H5Pget_layout(plan_.id()) == H5D_VIRTUAL || h5.H5Pget_external_count(plan_.id()) > 0)
        refuse(expected, "a data set whose numbers lie in other files");
}

/// A shape costs nothing to write: HDF5 makes up what the file does not hold.
void Hdf5Data::check_stored() const {
    const Hdf5Library& h5 = hdf5();
    const double needed = std::accumulate(shape_.begin(), shape_.end(),
                                          double(h5.H5Tget_size(type_.id())), std::multiplies{});
    const hsize_t stored = h5.H5Dget_storage_size(set_.id());
    if (needed > double(stored) * largest_inflation(plan_.id()))
        refuse("the data of " + shape_text() + " numbers", std::to_string(stored) + " bytes");
}

bool Hdf5Data::read_as(std::uint64_t first, std::uint64_t count, std::int64_t kind,
                       std::size_t size, const char* member, void* into) const {
    const Lock lock{hdf5_mutex()};
    const Hdf5Library& h5 = hdf5();
    Hdf5Handle record;
    if (member != nullptr) {
        record = {h5.H5Tcreate(H5T_COMPOUND, size), h5.H5Tclose};
        if (h5.H5Tinsert(record.id(), member, 0, kind) < 0) return false;
        kind = record.id();
    }
    // Each number as it is held or as it is wanted, whichever is wider.
    const std::uint64_t widest = std::max(size, h5.H5Tget_size(type_.id()));
    const Hdf5Handle transfer = transfer_of(count * row_length() * widest);
    if (shape_.empty())
        return h5.H5Dread(set_.id(), kind, H5S_ALL, H5S_ALL, transfer.id(), into) >= 0;
    std::vector<hsize_t> start(shape_.size(), 0), part(shape_.begin(), shape_.end());
    start[0] = first;
    part[0] = count;
    const Hdf5Handle memory{h5.H5Screate_simple(int(part.size()), part.data(), nullptr),
                            h5.H5Sclose};
    return h5.H5Sselect_hyperslab(space_.id(), H5S_SELECT_SET, start.data(), nullptr, part.data(),
                                  nullptr) >= 0 &&
           h5.H5Dread(set_.id(), kind, memory.id(), space_.id(), transfer.id(), into) >= 0;
}

template <typename T>
bool Hdf5Data::read(std::uint64_t first, std::span<T> into, const char* member) const {
    const std::uint64_t length = row_length();
    const std::uint64_t count = length == 0 ? 0 : into.size() / length;
    if (count == 0 || first > rows() || count > rows() - first) return count == 0;
    return read_as(first, count, native_kind<T>(), sizeof(T), member, into.data());
}

template <typename T>
std::optional<T> Hdf5Data::number(std::uint64_t row, const char* member, std::size_t column) const {
    std::vector<T> values(static_cast<std::size_t>(row_length()));
    if (column >= values.size() || row >= rows() || !read<T>(row, values, member)) return {};
    return values[column];
}

#define EVENTIDE_READ(T)                                                             \
    template bool Hdf5Data::read<T>(std::uint64_t, std::span<T>, const char*) const; \
    template std::optional<T> Hdf5Data::number<T>(std::uint64_t, const char*, std::size_t) const;
EVENTIDE_READ(double)
EVENTIDE_READ(std::int32_t)
EVENTIDE_READ(std::int64_t)
EVENTIDE_READ(std::uint8_t)
EVENTIDE_READ(std::uint16_t)
#undef EVENTIDE_READ

std::optional<double> Hdf5Data::number_attribute(const std::string& name) const {
    const Lock lock{hdf5_mutex()};
    const Hdf5Library& h5 = hdf5();
    if (h5.H5Aexists(set_.id(), name.c_str()) <= 0) return {};
    const Hdf5Handle attribute{h5.H5Aopen(set_.id(), name.c_str(), H5P_DEFAULT), h5.H5Aclose};
    const Hdf5Handle space{h5.H5Aget_space(attribute.id()), h5.H5Sclose};
    double value = 0;
    if (!space.good() || h5.H5Sget_simple_extent_npoints(space.id()) != 1 ||
        h5.H5Aread(attribute.id(), h5.H5T_NATIVE_DOUBLE_g, &value) < 0)
        return {};
    return value;
}

}  // namespace eventide
