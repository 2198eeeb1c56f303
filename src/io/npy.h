// One array as NumPy's save writes it: a header in text, then the numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// What the header of an .npy file (formats 1 to 3) says.
struct NpyHeader {
    char kind = 'f';                  ///< f float, i signed, u unsigned, b boolean
    int item_bytes = 4;               ///< 1, 2, 4 or 8
    std::vector<std::int64_t> shape;  ///< row-major: the last index is contiguous
    std::size_t data_offset = 0;      ///< bytes before the first number
    std::uint64_t count = 1;          ///< numbers, the product of `shape`
};

/// `begin` holds the file's first bytes, as many as the header needs. Throws Error(input) naming
/// `name` where that is no header of numbers in C order and little endian.
NpyHeader parse_npy_header(std::span<const std::byte> begin, const std::string& name);

/// Number i of an array; `data` begins with its first number.
double npy_number(const NpyHeader& header, const std::byte* data, std::size_t i);

/// A large array on disk, read in parts.
class NpyFile {
public:
    /// Throws Error(input).
    explicit NpyFile(const std::filesystem::path& path);

    const std::string& name() const { return name_; }
    const NpyHeader& header() const { return header_; }
    /// The shape's first number; 0 for a single number.
    std::uint64_t rows() const;
    /// Numbers per row.
    std::uint64_t row_length() const;
    /// Rows [first, first + count) as numbers. Throws Error(input) where the file is too short.
    std::vector<double> read(std::uint64_t first_row, std::uint64_t rows);

private:
    std::string name_;
    std::ifstream file_;
    NpyHeader header_;
};

}  // namespace eventide
