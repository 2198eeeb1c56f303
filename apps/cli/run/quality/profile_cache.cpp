// Profiles in the user's cache.
#include "apps/cli/run/quality/profile_cache.h"

#include "apps/cli/printable.h"
#include "src/core/environment.h"
#include "src/core/error.h"
#include "src/io/output_file.h"

#include <spdlog/spdlog.h>

#include <fstream>
#include <iterator>
#include <system_error>

namespace eventide::app {

namespace fs = std::filesystem;

namespace {

/// The standard has relative ones ignored.
fs::path absolute_folder(const char* variable) {
    const char* const value = environment_value(variable);
    const fs::path path = value == nullptr ? "" : value;
    return path.is_absolute() ? path : fs::path{};
}

/// Letters and digits of a name, in lower case, with single hyphens for the rest.
std::string slug(const std::string& name) {
    constexpr std::size_t kMax = 60;
    std::string text;
    for (const char c : name) {
        const bool upper = c >= 'A' && c <= 'Z';
        if (upper || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
            text += upper ? char(c - 'A' + 'a') : c;
        else if (!text.empty() && text.back() != '-')
            text += '-';
    }
    text.resize(std::min(text.size(), kMax));
    while (text.ends_with('-')) text.pop_back();
    return text;
}

/// Empty where there is none, or none that holds.
std::optional<QualityProfile> read_profile(const fs::path& file, const ProfileKey& key) {
    std::ifstream in{file, std::ios::binary};
    if (!in) return {};
    // More than any profile has: somebody else's file.
    constexpr std::size_t kMax = 1 << 16;
    std::string text(kMax, '\0');
    in.read(text.data(), std::streamsize(text.size()));
    text.resize(std::size_t(in.gcount()));
    try {
        return parse_profile(text, key);
    } catch (const Error& error) {
        spdlog::warn("{}: {}; what this processor does is measured anew", printable(file.string()),
                     printable(error.what()));
        return {};
    }
}

void keep(const fs::path& folder, const fs::path& file, const QualityProfile& profile) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    try {
        write_file(file, profile_text(profile), true);
    } catch (const std::exception& error) {
        spdlog::warn("the measured profile is not kept: {}", printable(error.what()));
    }
}

}  // namespace

fs::path cache_folder() {
    if (const fs::path cache = absolute_folder("XDG_CACHE_HOME"); !cache.empty())
        return cache / "eventide";
    const fs::path home = absolute_folder("HOME");
    return home.empty() ? fs::path{} : home / ".cache" / "eventide";
}

std::string profile_name(const ProfileKey& key) {
    return slug(key.processor.substr(0, key.processor.find(" ("))) + "_" + slug(key.instructions) +
           "_" + slug(key.kernels) + "_" + slug(key.identity) + "_" + std::to_string(key.width) +
           "x" + std::to_string(key.height) + ".json";
}

CachedProfile cached_profile(const fs::path& folder, const ProfileKey& key,
                             const std::function<QualityProfile()>& measure) {
    const fs::path file = folder.empty() ? fs::path{} : folder / profile_name(key);
    if (!file.empty())
        if (auto kept = read_profile(file, key)) return {std::move(*kept), false, file};
    CachedProfile made{measure(), true, file};
    if (!file.empty()) keep(folder, file, made.profile);
    return made;
}

}  // namespace eventide::app
