// Filters by the numbers under which they are registered with the HDF Group.
#include "src/io/hdf5/hdf5_filters.h"

#include "src/core/error.h"
#include "src/io/hdf5/hdf5_library.h"

#include <algorithm>
#include <array>
#include <vector>

namespace eventide {

namespace {

struct KnownFilter {
    int number;
    const char *name, *remedy;
};

constexpr std::array kKnownFilters{
    KnownFilter{32001, "blosc", "Debian's package is hdf5-filter-plugin-blosc-serial"},
    KnownFilter{32000, "LZF", "Debian's package is hdf5-plugin-lzf"},
    KnownFilter{307, "bzip2", "Debian's package is hdf5-filter-plugin"},
    KnownFilter{32004, "LZ4", "Debian's package is hdf5-filter-plugin"},
    KnownFilter{32008, "bitshuffle", "Debian's package is hdf5-filter-plugin"},
    KnownFilter{32015, "Zstandard", "python3-hdf5plugin brings one"},
    KnownFilter{0x8ECF, "ECF",
                "Prophesee's is at github.com/prophesee-ai/hdf5_ecf, and part of OpenEB"},
};

std::vector<int> filters_of(std::int64_t plan) {
    const Hdf5Library& h5 = hdf5();
    std::vector<int> numbers;
    for (int i = 0; i < h5.H5Pget_nfilters(plan); ++i) {
        unsigned flags = 0, configuration = 0;
        std::size_t values = 0;
        const auto number = h5.H5Pget_filter2(plan, unsigned(i), &flags, &values, nullptr, 0,
                                              nullptr, &configuration);
        if (number >= 0) numbers.push_back(number);
    }
    return numbers;
}

}  // namespace

void check_filters(const std::string& name, std::int64_t plan) {
    for (const int number : filters_of(plan)) {
        if (hdf5().H5Zfilter_avail(number) > 0) continue;
        const auto known = std::ranges::find(kKnownFilters, number, &KnownFilter::number);
        const bool found = known != kKnownFilters.end();
        throw Error(ErrorKind::input, name + ": packed with " +
                                          (found ? known->name : "an unknown filter") +
                                          " (HDF5 filter " + std::to_string(number) +
                                          "), whose plug-in the HDF5 library does not find" +
                                          (found ? std::string("; ") + known->remedy : "") +
                                          "; HDF5_PLUGIN_PATH names the folder of plug-ins");
    }
}

double largest_inflation(std::int64_t plan) {
    constexpr double kDeflate = 1032;   // 258 bytes from 2 bits
    constexpr double kOther = 1 << 20;  // of a block of equal bytes, no more than such a block
    const std::vector<int> filters = filters_of(plan);
    const auto packs = [](int number) {
        return number != H5Z_FILTER_SHUFFLE && number != H5Z_FILTER_FLETCHER32 &&
               number != H5Z_FILTER_DEFLATE;
    };
    if (std::ranges::any_of(filters, packs)) return kOther;
    return std::ranges::count(filters, int(H5Z_FILTER_DEFLATE)) > 0 ? kDeflate : 1;
}

}  // namespace eventide
