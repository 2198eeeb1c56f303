// Owns what the HDF5 library gives out by number.
#pragma once

#include <cstdint>

namespace eventide {

/// A file, data set, type, ... that has to be closed; closes it.
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

}  // namespace eventide
