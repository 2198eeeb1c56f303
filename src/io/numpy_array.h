// The header of a NumPy array: of numbers, or of records.
#pragma once

#include "src/io/byte_source.h"

#include <cstdint>
#include <string>
#include <vector>

namespace eventide {

struct NumpyField {
    std::string name;          ///< empty: the array is of numbers
    char kind = 'f';           ///< f float, i signed, u unsigned, b boolean; else not read
    std::uint64_t bytes = 4;   ///< of one
    std::uint64_t offset = 0;  ///< bytes from the record's beginning
    bool is_number() const;
};

struct NumpyArray {
    std::vector<NumpyField> fields;
    std::uint64_t record_bytes = 0;
    std::vector<std::uint64_t> shape;
    bool columns_first = false;  ///< Fortran order
    std::uint64_t data_offset = 0;
    bool is_cut = false;  ///< the shape is of the whole rows that there are, and was larger

    bool is_of_records() const { return !fields.empty() && !fields.front().name.empty(); }
    /// Whether it is of numbers (of a kind that is read), row-major: the last index is contiguous.
    bool is_of_numbers_in_rows() const;
    std::uint64_t rows() const { return shape.empty() ? 1 : shape.front(); }
    std::uint64_t items() const;  ///< numbers, or records: the product of `shape`
    std::string shape_text() const;
    /// The field of this name; null where there is none.
    const NumpyField* field(const std::string& name) const;
};

enum class CutArrays { refused, read };

/// Throws Error (input) beginning with `name`: no header, of kinds that are not read (big endian,
/// objects), or with a shape that the bytes do not hold. Where that is read, rows one behind the
/// other of records or of four numbers are enough, if there is one.
NumpyArray read_numpy_header(ByteSource& bytes, const std::string& name,
                             CutArrays cut = CutArrays::refused);

/// A number of the field, `at` its first byte.
double numpy_number(const NumpyField& field, const std::byte* at);
/// Saturated; of floating point ones the whole part.
std::int64_t numpy_integer(const NumpyField& field, const std::byte* at);

}  // namespace eventide
