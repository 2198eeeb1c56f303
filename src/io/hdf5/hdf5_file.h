// HDF5 files: what is in them, by name.
#pragma once

#include "src/io/hdf5/hdf5_data.h"

#include <string>
#include <vector>

namespace eventide {

class Hdf5File {
public:
    /// Throws Error (input) naming the path where it is no HDF5 file or cut short.
    explicit Hdf5File(const std::string& path);

    const std::string& path() const { return path_; }
    /// Whether there is a data set or group of this name; false also for a link that leads nowhere.
    bool has(const std::string& name) const;
    /// Throws Error (input): none of that name, or packed in a way that is not understood here,
    /// with what remedies that, or not all that its shape says is stored.
    Hdf5Data data(const std::string& name) const;
    /// Names in a group, in alphabetical order; of the whole file with "/".
    std::vector<std::string> names_in(const std::string& group) const;

    /// Attribute `name` of the group or data set `object` ("/" is the file itself). Empty where
    /// there is none.
    std::vector<double> number_attributes(const std::string& object, const std::string& name) const;
    std::string text_attribute(const std::string& object, const std::string& name) const;

private:
    std::string path_;
    Hdf5Handle file_;
};

}  // namespace eventide
