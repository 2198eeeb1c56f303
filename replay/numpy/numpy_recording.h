// Events in NumPy's files.
#pragma once

#include "replay/data_reader.h"
#include "replay/open_options.h"

#include <memory>
#include <string>

namespace eventide {

/// An .npy file: records with fields t, x, y, p, or numbers [event][4]. Columns and the unit of
/// time as of text: named, stated by the options, or guessed from the numbers. Throws Error (input)
/// naming what was expected and what was found.
std::unique_ptr<DataReader> open_npy(const std::string& path, const OpenOptions& options);

/// An .npz file: arrays t, x, y and p, or one as above.
std::unique_ptr<DataReader> open_npz(const std::string& path, const OpenOptions& options);

}  // namespace eventide
