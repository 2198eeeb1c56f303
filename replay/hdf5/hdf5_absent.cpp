// Where eventide was built without HDF5 (EVENTIDE_HDF5).
#include "replay/hdf5/hdf5_recording.h"
#include "replay/hdf5/hdf5_writer.h"
#include "src/core/error.h"

namespace eventide {

namespace {

[[noreturn]] void refuse(const std::string& path) {
    throw Error(ErrorKind::failed,
                path + ": eventide was built without HDF5 (EVENTIDE_HDF5; Debian's libhdf5-dev)");
}

}  // namespace

std::unique_ptr<DataReader> open_hdf5(const std::string& path, const OpenOptions&) {
    refuse(path);
}

std::unique_ptr<FileWriter> make_hdf5_writer(OutputFile& file, const StreamHeader&) {
    refuse(file.name());
}

}  // namespace eventide
