// Recordings in HDF5 files, in the layouts of the usual data sets.
#pragma once

#include "replay/data_reader.h"
#include "replay/open_options.h"

#include <memory>
#include <string>

namespace eventide {

/// Layouts: DSEC (events/x y p t, ms_to_idx, t_offset), MVSEC (davis/left/events, image_raw), M3ED
/// (prophesee/left/x y t p, ms_map_idx), Prophesee (CD/events), event_utils (events/xs ys ts ps,
/// images), e2calib (x y t p). Throws Error (input) naming what was expected and what was found;
/// failed where HDF5 is missing, or eventide was built without it.
std::unique_ptr<DataReader> open_hdf5(const std::string& path, const OpenOptions& options);

}  // namespace eventide
