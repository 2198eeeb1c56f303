// HDF5 files in the layout of DSEC.
#pragma once

#include "replay/file_writer.h"
#include "src/codec/stream.h"
#include "src/io/output_file.h"

#include <memory>

namespace eventide {

/// events/{x,y,t,p} (u16, u16, i64 us after t_offset, u8), ms_to_idx (the first event of each ms),
/// t_offset, packed with shuffle and deflate; images as event_utils has them (images/imageNNNNNNNNN
/// with timestamp and event_idx), those of a part of the sensor on black; the sensor's size as
/// sensor_resolution, height first. `file` is borrowed and must be a file. Throws Error (usage) for
/// a pipe.
std::unique_ptr<FileWriter> make_hdf5_writer(OutputFile& file, const StreamHeader& header);

}  // namespace eventide
