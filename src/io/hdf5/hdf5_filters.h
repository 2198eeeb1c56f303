// How the blocks of an HDF5 data set are packed, and whether that is understood here.
#pragma once

#include <cstdint>
#include <string>

namespace eventide {

/// `plan`: a data set's creation property list. Throws Error (input) naming the data set, the
/// packing and the plug-in of the HDF5 library that is missing.
void check_filters(const std::string& name, std::int64_t plan);

/// How many bytes one stored byte can at most stand for.
double largest_inflation(std::int64_t plan);

}  // namespace eventide
