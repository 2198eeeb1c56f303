// Arrays of numbers as NumPy's savez writes them: a zip archive of .npy files.
#pragma once

#include "src/io/zip_directory.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace eventide {

/// Row-major: the last index of `shape` is contiguous.
struct NpzArray {
    std::vector<std::int64_t> shape;
    std::vector<float> values;
};

/// Reads the whole file at construction and each array when it is asked for, so that arrays of
/// kinds nobody wants (text, integers) do no harm. Every length in the file is checked against
/// what is there.
class NpzFile {
public:
    /// Throws Error(input) where the file cannot be read or is not a zip archive of stored or
    /// deflated entries.
    explicit NpzFile(const std::filesystem::path& path);

    bool contains(const std::string& name) const { return entries_.count(name) != 0; }

    /// `name` without ".npy". Throws Error(input) naming the array where it is missing, damaged,
    /// not float32 or float64, or in Fortran order.
    NpzArray array(const std::string& name) const;

    const std::string& file() const { return file_; }

private:
    std::vector<std::byte> unpacked(const std::string& name) const;
    [[noreturn]] void refuse(const std::string& what) const;

    std::string file_;
    std::vector<std::byte> bytes_;
    std::map<std::string, ZipEntry> entries_;  // without ".npy"
};

}  // namespace eventide
