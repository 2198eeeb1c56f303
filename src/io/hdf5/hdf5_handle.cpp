// Closing what the HDF5 library gave out.
#include "src/io/hdf5/hdf5_handle.h"

#include "src/io/hdf5/hdf5_library.h"

#include <utility>

namespace eventide {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

Hdf5Handle::Hdf5Handle(Hdf5Handle&& other) noexcept
    : id_(std::exchange(other.id_, -1)), close_(other.close_) {}

Hdf5Handle& Hdf5Handle::operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
}

Hdf5Handle::~Hdf5Handle() {
    close();
}

bool Hdf5Handle::close() {
    if (id_ < 0) return true;
    const std::lock_guard lock{hdf5_mutex()};
    return close_(std::exchange(id_, -1)) >= 0;
}

}  // namespace eventide
