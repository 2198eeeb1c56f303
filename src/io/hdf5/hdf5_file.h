// HDF5 files, read a part of each data set at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// Something of HDF5's that wants to be closed.
class Hdf5Handle {
public:
    using Close = int (*)(std::int64_t);
    Hdf5Handle() = default;
    Hdf5Handle(std::int64_t id, Close how) : id_(id), close_(how) {}
    Hdf5Handle(Hdf5Handle&& other) noexcept;
    Hdf5Handle& operator=(Hdf5Handle&& other) noexcept;
    Hdf5Handle(const Hdf5Handle&) = delete;
    Hdf5Handle& operator=(const Hdf5Handle&) = delete;
    ~Hdf5Handle();
    std::int64_t id() const { return id_; }
    bool good() const { return id_ >= 0; }
    /// False where the library could not write what was still to be written.
    bool close();

private:
    std::int64_t id_ = -1;
    Close close_ = nullptr;
};

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
    Hdf5Data() = default;
    bool read_as(std::uint64_t first, std::uint64_t count, std::int64_t kind, std::size_t size,
                 const char* member, void* into) const;
    void check_blocks() const;
    void check_stored() const;
    std::uint64_t block_bytes() const;

    std::string name_;
    Hdf5Handle set_, space_, type_, plan_;
    std::vector<std::uint64_t> shape_;
    Kind kind_ = Kind::other;
};

class Hdf5File {
public:
    /// Throws Error (input) naming the path where it is no HDF5 file or cut short.
    explicit Hdf5File(const std::string& path);

    const std::string& path() const { return path_; }
    /// Of data set or group; false also where it leads nowhere.
    bool has(const std::string& name) const;
    /// Throws Error (input): none of that name, or packed in a way that is not understood here,
    /// with what remedies that, or not all that its shape says is stored.
    Hdf5Data data(const std::string& name) const;
    /// Names in a group, in alphabetical order; of the whole file with "/".
    std::vector<std::string> names_in(const std::string& group) const;

    /// Of the group or data set `object` ("/" is the file itself). Empty where there is none.
    std::vector<double> number_attributes(const std::string& object, const std::string& name) const;
    std::string text_attribute(const std::string& object, const std::string& name) const;

private:
    std::string path_;
    Hdf5Handle file_;
};

}  // namespace eventide
