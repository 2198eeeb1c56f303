// Inputs and outputs that are more than one file, named file by file; and results that are one.
#include "apps/cli/commands/command_files.h"

#include "replay/ecd_folder.h"
#include "src/core/error.h"
#include "src/io/output_file.h"

#include <string_view>

namespace eventide::app {

namespace fs = std::filesystem;

void name_recording(const std::string& option, const std::string& path, NamedFiles& files) {
    const auto folder = find_ecd_folder(path);
    files.reads(option, path);
    if (!folder) return;
    files.reads(option, *folder);
    for (const char* name : {"events.txt", "images.txt", "exposure.txt"})
        files.reads(option, fs::path{*folder} / name);
    for (const auto& image : read_ecd_images(*folder).entries) files.reads(option, image.path);
}

void name_files(const std::string& option, const fs::path& path, NamedFiles& files) {
    std::error_code none;
    if (fs::is_directory(path, none))
        files.reads_all(option, path);
    else
        files.reads(option, path);
}

void name_filter_files(const std::vector<std::string>& filters, NamedFiles& files) {
    constexpr std::string_view kHotPixels = "hot-pixels:";
    for (const std::string& filter : filters)
        if (filter.starts_with(kHotPixels) && filter != "hot-pixels:learn")
            files.reads("--filter", filter.substr(kHotPixels.size()));
}

void name_run_folder(const std::string& option, const fs::path& folder,
                     const RunFolderFiles& written, NamedFiles& files) {
    files.writes_folder(option, folder);
    std::error_code none;
    for (const std::string& name : written.single) {
        files.writes(option, folder / name);
        // What a killed run left goes, too.
        if (const fs::path part = folder / (name + ".part"); fs::exists(part, none))
            files.writes(option, part);
    }
    files.writes(option, folder / kRunRecord);
    for (const NumberedFiles& numbered : written.numbered)
        files.writes_all(option, folder / numbered.folder);
}

void write_result(const std::string& file, const std::string& text, bool overwrite,
                  const Signals& signals) {
    if (file.empty()) return;
    OutputFile out{file,
                   {.overwrite = overwrite, .give_up = [&signals] { return signals.stopping(); }}};
    out.write(text);
    out.close();
    if (!out.is_read() && signals.stopping())
        throw Error(ErrorKind::failed,
                    file + ": stopped by a signal, and " + std::string{text_of(out.reader())});
}

}  // namespace eventide::app
