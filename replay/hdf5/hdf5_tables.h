// Events and images in an HDF5 file, in each of the ways they are laid out.
#pragma once

#include "replay/event_table.h"
#include "src/io/hdf5/hdf5_file.h"

#include <memory>
#include <optional>
#include <string>

namespace eventide {

/// Data sets of one column each, or one of records. Times are in us where they are whole numbers,
/// else in seconds.
struct Hdf5Columns {
    std::string x, y, t, p;  ///< data sets; of records: their members
    std::string records;     ///< data set; empty: there is one for each column
    std::string index;       ///< the first row of each ms of t; empty: none
    std::int64_t offset_us = 0;
};

/// Throws Error (input) where a column is missing, no column of numbers, or longer than another.
std::unique_ptr<EventTable> open_hdf5_columns(const Hdf5File& file, const Hdf5Columns& columns);

/// [event][x y t p], t in seconds. Throws as above.
std::unique_ptr<EventTable> open_hdf5_matrix(const Hdf5File& file, const std::string& name);

/// [image][y][x] of 8 or 16 bit, with a time in seconds for each. Throws as above.
std::unique_ptr<ImageTable> open_hdf5_stack(const Hdf5File& file, const std::string& images,
                                            const std::string& times);

/// images/image000000000 and on, each [y][x] or [y][x][3] (BGR) with an attribute `timestamp` in
/// seconds. Null where there are none.
std::unique_ptr<ImageTable> open_hdf5_images(const Hdf5File& file, const std::string& group);

struct Hdf5Size {
    int width = 0, height = 0;
};
/// Size of the images in an array of one or more; `rows_at` is the axis of their rows. Refuses what
/// no sensor has.
Hdf5Size size_of_images(const Hdf5Data& images, std::size_t rows_at);

}  // namespace eventide
