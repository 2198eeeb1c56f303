// Inputs and outputs that are more than one file, named file by file; and results that are one.
#pragma once

#include "apps/cli/signals.h"
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

/// What a command found, to a file, or to standard output for "-"; nothing where `file` is empty.
/// Throws Error as OutputFile does, and failed where a signal ended the wait for a pipe's reader.
void write_result(const std::string& file, const std::string& text, bool overwrite,
                  const Signals& signals);

}  // namespace eventide::app
