// A large array of numbers on disk, read in parts.
#pragma once

#include "replay/numpy/file_bytes.h"
#include "src/io/numpy_array.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

class NumpyFile {
public:
    /// Throws Error (input) where it cannot be opened, is no array of numbers in C order and little
    /// endian, or is shorter than its header says.
    explicit NumpyFile(const std::filesystem::path& path);

    const std::string& name() const { return file_.path(); }
    const NumpyArray& array() const { return array_; }
    /// The type that all numbers of the array have.
    const NumpyField& number() const { return array_.fields.front(); }
    /// The shape's first number; 1 for a single number.
    std::uint64_t rows() const { return array_.rows(); }
    /// Numbers per row.
    std::uint64_t row_length() const;
    /// Rows [first, first + count) as numbers. Throws Error (input) where there are not so many.
    std::vector<double> read(std::uint64_t first, std::uint64_t count);

private:
    ByteFile file_;
    StoredBytes bytes_;
    NumpyArray array_;
};

}  // namespace eventide
