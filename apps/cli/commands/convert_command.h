// eventide convert: a recording in another format.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/settings/input_settings.h"
#include "apps/cli/settings/time_point.h"

namespace eventide::app {

class ConvertCommand : public Command {
public:
    std::string name() const override { return "convert"; }
    std::string summary() const override { return "Write a recording in another format"; }
    std::string examples() const override;
    std::vector<Positional> positionals() override;
    SettingTable settings() override;
    int run(Program& program) override;

private:
    std::string from_file_, to_file_, to_format_ = "auto";
    InputSettings input_;
    std::optional<TimePoint> from_, to_;
    std::vector<std::string> filter_;
    bool overwrite_ = false, force_ = false, strict_ = false;
};

}  // namespace eventide::app
