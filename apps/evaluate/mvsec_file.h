// MVSEC's own files (Zhu et al. 2018): SEQUENCE_data.hdf5, of which the left DAVIS is read.
#pragma once

#include "apps/evaluate/reference_sequence.h"

#include <filesystem>
#include <optional>

namespace eventide {

/// By its name.
inline bool is_hdf5_file(const std::filesystem::path& path) {
    return path.extension() == ".hdf5" || path.extension() == ".h5";
}

/// Reads davis/left: `events` [event][x y t p], `image_raw` [image][y][x] of 8 bit, `image_raw_ts`,
/// and `image_raw_event_inds`, the last event before each image, which must agree with the times.
/// Times are told from the first event or image, whichever comes first; only [from_s, to_s] is
/// kept. Throws Error(input) naming the data set, what was expected and what was found; also where
/// eventide was built without HDF5 (EVENTIDE_HDF5).
ReferenceSequence read_mvsec_file(const std::filesystem::path& path, std::optional<double> from_s,
                                  std::optional<double> to_s);

}  // namespace eventide
