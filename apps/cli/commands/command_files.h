// Inputs and outputs that are more than one file, named file by file.
#pragma once

#include "pipeline/sinks/run_folder.h"
#include "src/io/named_files.h"

#include <filesystem>
#include <string>
#include <vector>

namespace eventide::app {

/// A recording: a file, standard input, or a folder of the Event Camera Dataset with the images it
/// lists. Throws Error (usage).
void name_recording(const std::string& option, const std::string& path, NamedFiles& files);

/// A file, or a folder that is read as a whole.
void name_files(const std::string& option, const std::filesystem::path& path, NamedFiles& files);

/// Lists of hot pixels that --filter takes. Throws Error (usage).
void name_filter_files(const std::vector<std::string>& filters, NamedFiles& files);

/// What a run writes into a folder. Throws Error (usage).
void name_run_folder(const std::string& option, const std::filesystem::path& folder,
                     const RunFolderFiles& written, NamedFiles& files);

}  // namespace eventide::app
