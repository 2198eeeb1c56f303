// Data sets of any kind, shape and content under the names of each layout. The file itself is made
// by the HDF5 library, which is trusted with its own structures.
#include "tests/fuzz/fuzz_recording_as.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <vector>

namespace eventide {
namespace {

using Names = std::vector<const char*>;

const std::array<Names, 6> kLayouts{{
    {"events/x", "events/y", "events/t", "events/p", "ms_to_idx", "t_offset",
     "images/image000000000", "images/image000000001"},
    {"davis/left/events", "davis/left/image_raw", "davis/left/image_raw_ts"},
    {"prophesee/left/x", "prophesee/left/y", "prophesee/left/t", "prophesee/left/p",
     "prophesee/left/ms_map_idx", "prophesee/left/calib/resolution"},
    {"CD/events"},
    {"events/xs", "events/ys", "events/ts", "events/ps", "images/image000000000"},
    {"x", "y", "t", "p"},
}};

/// The input from front to back; behind its end zeros.
class Input {
public:
    Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}
    std::uint8_t byte() {
        if (rest_.empty()) return 0;
        const std::uint8_t first = rest_.front();
        rest_ = rest_.subspan(1);
        return first;
    }
    /// `n` bytes, the content of a data set; over and over where fewer are left.
    std::vector<std::uint8_t> content(std::size_t n) {
        std::vector<std::uint8_t> bytes(n);
        for (std::size_t i = 0; i < n && !rest_.empty(); ++i) bytes[i] = rest_[i % rest_.size()];
        rest_ = rest_.subspan(std::min(n, rest_.size()));
        return bytes;
    }

private:
    std::span<const std::uint8_t> rest_;
};

/// {x, y, p, t}, one of them perhaps missing.
hid_t records_type(std::uint8_t missing) {
    const hid_t type = H5Tcreate(H5T_COMPOUND, 16);
    if (missing != 1) H5Tinsert(type, "x", 0, H5T_STD_U16LE);
    if (missing != 2) H5Tinsert(type, "y", 2, H5T_STD_U16LE);
    if (missing != 3) H5Tinsert(type, "p", 4, H5T_STD_I16LE);
    if (missing != 4) H5Tinsert(type, "t", 8, H5T_STD_I64LE);
    return type;
}

/// Of kind & 7, as a copy that is to be closed.
hid_t type_of(std::uint8_t kind, bool records) {
    if (records && (kind & 7) < 5) return records_type(kind & 7);
    switch (kind & 7) {
        case 0:
            return H5Tcopy(H5T_STD_U16LE);
        case 1:
            return H5Tcopy(H5T_STD_I64LE);
        case 2:
            return H5Tcopy(H5T_IEEE_F64LE);
        case 3:
            return H5Tcopy(H5T_STD_U8LE);
        case 4:
            return H5Tcopy(H5T_STD_U64BE);
        case 5:
            return H5Tcopy(H5T_IEEE_F32LE);
        case 6:
            return H5Tcopy(H5T_C_S1);
        default:
            return H5Tcopy(H5T_STD_I8LE);
    }
}

void add_attribute(hid_t object, const char* name, Input& input) {
    const hid_t type = type_of(input.byte(), false);
    const hsize_t count = input.byte() % 4;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t made = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const auto values = input.content(std::size_t(count) * 8);
    if (count > 0) H5Awrite(made, type, values.data());
    H5Aclose(made);
    H5Sclose(space);
    H5Tclose(type);
}

void add_data(hid_t file, hid_t links, const char* name, hsize_t rows, Input& input) {
    const std::uint8_t kind = input.byte(), form = input.byte();
    if (form == 0xFF) return;  // left out
    const int rank = form % 4;
    std::array<hsize_t, 3> shape{rows, 4, 4};
    if ((form & 4) != 0) shape[0] = input.byte();
    if ((form & 8) != 0) shape[1] = input.byte() % 24;
    if ((form & 16) != 0) shape[2] = input.byte() % 24;
    const hid_t type = type_of(kind, std::string_view{name} == "CD/events");
    const hid_t space = H5Screate_simple(rank, shape.data(), nullptr);
    const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
    const bool empty = std::ranges::count(shape.begin(), shape.begin() + rank, hsize_t{0}) > 0;
    if ((form & 32) != 0 && rank > 0 && !empty) {
        H5Pset_chunk(plan, rank, shape.data());
        H5Pset_shuffle(plan);
        H5Pset_deflate(plan, 1);
    }
    const hid_t set = H5Dcreate2(file, name, type, space, links, plan, H5P_DEFAULT);
    const auto values =
        input.content(std::size_t(H5Sget_simple_extent_npoints(space)) * H5Tget_size(type));
    if (!values.empty()) H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    if (std::string_view{name}.starts_with("images/")) add_attribute(set, "timestamp", input);
    H5Dclose(set);
    H5Pclose(plan);
    H5Sclose(space);
    H5Tclose(type);
}

void make_file(const std::string& path, Input input) {
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    require(file >= 0);
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const Names& names = kLayouts[input.byte() % kLayouts.size()];
    const hsize_t rows = input.byte();
    for (const char* name : names) add_data(file, links, name, rows, input);
    if (input.byte() > 0) add_attribute(file, "sensor_resolution", input);
    if (input.byte() > 0) add_attribute(file, "geometry", input);
    H5Pclose(links);
    H5Fclose(file);
}

}  // namespace
}  // namespace eventide

/// The library keeps memory for later, which would be looked at for leaks after each input.
extern "C" const char* __asan_default_options() {
    return "detect_leaks=0";
}

/// What the library frees is kept for its next file: half a MiB for each one opened, which would
/// come from the system and be cleared page by page.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
    return H5set_free_list_limits(-1, -1, -1, -1, -1, -1);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static const MemoryFile file;
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    make_file(file.path(), {data, size});
    fuzz_recording_at(file.path(), "hdf5");
    return 0;
}
