// eventide info: what a recording or a model holds.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/settings/input_settings.h"

namespace eventide::app {

class InfoCommand : public Command {
public:
    std::string name() const override { return "info"; }
    std::string summary() const override { return "Show information about a recording or model"; }
    std::string examples() const override;
    std::vector<Positional> positionals() override;
    SettingTable settings() override;
    int run(Program& program) override;

private:
    int describe_model(const std::filesystem::path& file) const;

    std::string file_;
    InputSettings input_;
    bool json_ = false, strict_ = false;
};

}  // namespace eventide::app
