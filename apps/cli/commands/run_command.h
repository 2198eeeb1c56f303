// eventide run: events in, frames and sigma out.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/settings/run_settings.h"

namespace eventide::app {

class RunCommand : public Command {
public:
    std::string name() const override { return "run"; }
    std::string summary() const override {
        return "Reconstruct video and sigma from a recording or camera";
    }
    std::string examples() const override;
    std::vector<Positional> positionals() override;
    SettingTable settings() override { return settings_.table(); }
    int run(Program& program) override;

private:
    RunSettings settings_;
};

}  // namespace eventide::app
