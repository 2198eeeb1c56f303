// Where the EVREAL protocol finds its sequences, and how it reads them.
#pragma once

#include "apps/evaluate/reference_sequence.h"

#include <filesystem>
#include <vector>

namespace eventide {

/// The sequences of a data set: `dataset` itself, or what lies in it, by name. A sequence is a
/// folder with events.txt and images.txt (Event Camera Dataset), a folder with events_ts.npy (as
/// EVREAL's tools convert ECD, MVSEC and HQF), a file of MVSEC (.hdf5), a ROS bag (HQF, .bag), or a
/// recording that brings its images along (.aedat4). Throws Error(input) where there is none.
std::vector<std::filesystem::path> evreal_sequences(const std::filesystem::path& dataset);

/// Reads one of them. Times are told from the first event or image, whichever comes first; only
/// [from_s, to_s] is kept, which may be nothing. Throws Error(input) where the recording has no
/// events or no images.
ReferenceSequence read_evreal_sequence(const std::filesystem::path& path,
                                       std::optional<double> from_s, std::optional<double> to_s);

}  // namespace eventide
