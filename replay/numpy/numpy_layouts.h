// How events lie in arrays: records, rows of four numbers, or an array for each column.
#pragma once

#include "replay/numpy/numpy_table.h"
#include "src/io/byte_source.h"
#include "src/io/numpy_array.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide {

struct NamedNumpyArray {
    std::string name;  ///< of an array in an archive, or its file; in messages
    std::shared_ptr<ByteSource> source;
    NumpyArray array;
};

/// Records with t, x, y and p, or rows of four numbers. False where it is neither. Throws Error
/// (input) for one that holds no numbers, or whose order cannot be read from a packed archive.
bool find_numpy_rows(const NamedNumpyArray& named, NumpyEvents& found);

/// An array for each of t, x, y and p. False where one is missing. Throws Error (input) for arrays
/// of different length or without numbers; `file` is for messages.
bool find_numpy_columns(const std::string& file, const std::vector<NamedNumpyArray>& arrays,
                        NumpyEvents& found);

}  // namespace eventide
