// Where models are found.
#include "src/model/model_folders.h"

#include "src/core/environment.h"
#include "src/core/error.h"
#include "src/core/list_text.h"

#include <dlfcn.h>

#include <algorithm>
#include <vector>

namespace eventide {

namespace fs = std::filesystem;

namespace {

/// The shared library this code is in. Of a program dladdr tells its name as it was called, which
/// says where it is only when it says all of it.
fs::path own_file() {
    Dl_info info{};
    if (dladdr(reinterpret_cast<const void*>(&find_model), &info) == 0) return {};
    if (info.dli_fname == nullptr || info.dli_fname[0] != '/') return {};
    std::error_code none;
    const fs::path file = fs::canonical(info.dli_fname, none);
    return none ? fs::path{} : file;
}

/// Adds what lies beside a binary: it is in bin/, lib/ or lib/MACHINE/ where it is installed, and
/// anywhere below the source tree where it was built.
void add_places_above(const fs::path& binary, std::vector<fs::path>& places) {
    std::error_code none;
    for (fs::path up = binary.parent_path(); up.has_relative_path(); up = up.parent_path()) {
        fs::path models = up / "share/eventide/models";
        if (fs::exists(up / "config/models", none) && fs::exists(up / "CMakeLists.txt", none))
            models = up / "config/models";
        if (!fs::is_directory(models, none) || std::ranges::count(places, models) > 0) continue;
        places.push_back(std::move(models));
        return;
    }
}

std::vector<fs::path> folders() {
    std::vector<fs::path> places;
    if (const char* chosen = environment_value("EVENTIDE_MODELS");
        chosen != nullptr && *chosen != '\0')
        places.emplace_back(chosen);
    std::error_code none;
    add_places_above(own_file(), places);
    add_places_above(fs::read_symlink("/proc/self/exe", none), places);
    return places;
}

std::string names_in(const std::vector<fs::path>& places) {
    std::vector<std::string> names;
    for (const fs::path& place : places) {
        std::error_code none;
        for (const auto& entry : fs::directory_iterator{place, none})
            if (entry.path().extension() == ".safetensors")
                names.push_back(entry.path().stem().string());
    }
    std::ranges::sort(names);
    return names.empty() ? "none" : list_of(names);
}

}  // namespace

fs::path find_model(const std::string& name) {
    std::error_code none;
    if (fs::is_regular_file(name, none)) return name;
    const auto places = folders();
    std::string looked;
    for (const fs::path& place : places) {
        fs::path file = place / (name + ".safetensors");
        if (name.find('/') == name.npos && fs::is_regular_file(file, none)) return file;
        add_to_list(looked, place.string());
    }
    throw Error(ErrorKind::input,
                "model '" + name + "': expected a file, or a name from the models folders (" +
                    (looked.empty() ? "there is none" : looked) + "); found there: " +
                    names_in(places) + "; EVENTIDE_MODELS names another folder");
}

}  // namespace eventide
