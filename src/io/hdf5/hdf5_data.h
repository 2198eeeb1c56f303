// A data set of an HDF5 file, read a part at a time.
#pragma once

#include "src/io/hdf5/hdf5_handle.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace eventide {

/// A data set of numbers, or of records of numbers. One thread at a time; several files may be read
/// on several threads.
class Hdf5Data {
public:
    enum class Kind { integer, floating, record, other };
    /// Larger than that no packed block may be: all of one is unpacked for any row of it.
    static constexpr std::uint64_t kLargestBlock = std::uint64_t{1} << 28;  // bytes

    const std::string& name() const { return name_; }  ///< "FILE: events/x"
    const std::vector<std::uint64_t>& shape() const { return shape_; }
    std::uint64_t rows() const { return shape_.empty() ? 1 : shape_[0]; }
    /// Numbers per row.
    std::uint64_t row_length() const;
    Kind kind() const { return kind_; }
    bool has_member(const std::string& member) const;
    bool is_narrow() const;  ///< numbers of 8 bit

    /// Rows [first, first + into.size() / row_length()) as numbers of that kind, or one member of
    /// records. False where they cannot be read. T: std::int32_t, std::int64_t, std::uint8_t,
    /// std::uint16_t, double.
    template <typename T>
    bool read(std::uint64_t first, std::span<T> into, const char* member = nullptr) const;

    /// One number of a row. Empty where it cannot be read.
    template <typename T>
    std::optional<T> number(std::uint64_t row, const char* member = nullptr,
                            std::size_t column = 0) const;

    /// Throws Error (input) naming the data set, what was expected and `what` was found.
    [[noreturn]] void refuse(const std::string& expected, const std::string& what) const;
    std::string shape_text() const;

    std::optional<double> number_attribute(const std::string& name) const;

private:
    friend class Hdf5File;
    explicit Hdf5Data(std::string name) : name_(std::move(name)) {}
    /// Throws as Hdf5File::data().
    void open(std::int64_t file, const std::string& path);
    bool read_as(std::uint64_t first, std::uint64_t count, std::int64_t kind, std::size_t size,
                 const char* member, void* into) const;
    void check_place(std::int64_t file) const;
    void check_blocks() const;
    void check_stored() const;
    std::uint64_t block_bytes() const;

    std::string name_;
    Hdf5Handle set_, space_, type_, plan_;
    std::vector<std::uint64_t> shape_;
    Kind kind_ = Kind::other;
};

}  // namespace eventide
