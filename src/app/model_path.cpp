// Where models are found.
#include "src/app/model_path.h"

#include "src/core/error.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace eventide::app {

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> folders() {
    std::vector<fs::path> places;
    if (const char* chosen = std::getenv("EVENTIDE_MODELS"); chosen != nullptr && *chosen != '\0')
        places.emplace_back(chosen);
    std::error_code none;
    const fs::path program = fs::read_symlink("/proc/self/exe", none);
    if (!none) {
        places.push_back(program.parent_path().parent_path() / "share/eventide/models");
        // A program that still lies in a build folder finds the tree above it.
        for (fs::path up = program.parent_path(); up.has_relative_path(); up = up.parent_path())
            if (fs::exists(up / "config/models", none) && fs::exists(up / "CMakeLists.txt", none)) {
                places.push_back(up / "config/models");
                break;
            }
    }
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
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text.empty() ? "none" : text;
}

}  // namespace

fs::path find_model(const std::string& name) {
    std::error_code none;
    if (fs::is_regular_file(name, none)) return name;
    const auto places = folders();
    std::string looked;
    for (const fs::path& place : places) {
        const fs::path file = place / (name + ".safetensors");
        if (name.find('/') == name.npos && fs::is_regular_file(file, none)) return file;
        looked += (looked.empty() ? "" : ", ") + place.string();
    }
    throw Error(ErrorKind::input, "model '" + name +
                                      "': expected a file, or a name from the models folders (" +
                                      looked + "); found there: " + names_in(places) +
                                      "; EVENTIDE_MODELS names another folder");
}

}  // namespace eventide::app
