// Profiles in the user's cache.
#pragma once

#include "apps/cli/run/quality/quality_profile.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace eventide::app {

/// eventide's folder in $XDG_CACHE_HOME or in ~/.cache; empty where neither is told.
std::filesystem::path cache_folder();

/// Named by processor, instructions, model and sensor:
/// "intel-r-xeon-r_avx-512_03f8..._346x260.json"
std::string profile_name(const ProfileKey& key);

struct CachedProfile {
    QualityProfile profile;
    bool measured = false;  ///< now; false: read from `file`
    std::filesystem::path file;
};

/// What the folder has for the key, else what `measure` gives, which is then kept there. What is
/// damaged or cannot be written is a warning in the log; an empty folder keeps nothing.
CachedProfile cached_profile(const std::filesystem::path& folder, const ProfileKey& key,
                             const std::function<QualityProfile()>& measure);

}  // namespace eventide::app
