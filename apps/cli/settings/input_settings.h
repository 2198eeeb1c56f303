// What the user may say about an input, the same for every command that reads one.
#pragma once

#include "apps/cli/command.h"
#include "replay/open_options.h"
#include "replay/recording.h"
#include "src/settings/setting.h"
#include "src/settings/values.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide::app {

struct InputSettings {
    OpenOptions open;
    std::optional<Size> size;  ///< of the sensor, where the recording does not say

    /// Appends the settings, all beginning with "input_".
    void add_to(SettingTable& table);
    OpenOptions options() const;
};

/// --filter, for every command that hands events on.
Setting filter_setting(std::vector<std::string>& filters);

/// For recordings in `formats`: throws Error (usage) for a flag about what none of them leaves
/// open, such as the order of columns in AEDAT 4.
void refuse_idle_input_flags(const FlagKeys& flags, const std::vector<std::string>& formats);

/// For commands that read recordings alone. Throws Error (usage) for the name of a camera or a
/// simulation where there is no such file.
void refuse_camera(const std::string& path);

/// open_recording() behind refuse_camera(), and its remarks as warnings. `give_up` as in
/// OpenOptions.
std::unique_ptr<Recording> open_input(const std::string& path, const InputSettings& input,
                                      std::function<bool()> give_up);

}  // namespace eventide::app
