// Built in place of mvsec_file.cpp where there is no HDF5 library.
#include "apps/evaluate/mvsec_file.h"
#include "src/core/error.h"

namespace eventide {

ReferenceSequence read_mvsec_file(const std::filesystem::path& path, std::optional<double>,
                                  std::optional<double>) {
    throw Error(ErrorKind::input,
                path.string() +
                    ": an HDF5 file, which this eventide cannot read: it was built "
                    "without EVENTIDE_HDF5 (scripts/install-packages.sh installs it)");
}

}  // namespace eventide
