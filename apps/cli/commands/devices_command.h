// eventide devices: which cameras there are, and why one cannot be used.
#pragma once

#include "apps/cli/command.h"

namespace eventide::app {

class DevicesCommand : public Command {
public:
    std::string name() const override { return "devices"; }
    std::string summary() const override { return "List cameras and diagnose problems"; }
    std::string examples() const override {
        return "Examples:\n  eventide devices\n  eventide devices --json";
    }
    SettingTable settings() override;
    int run(Program& program) override;

private:
    bool json_ = false;
};

}  // namespace eventide::app
