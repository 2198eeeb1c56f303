// eventide doctor: what this machine has of what eventide can use, and what to do about the rest.
#pragma once

#include "apps/cli/command.h"

namespace eventide::app {

class DoctorCommand : public Command {
public:
    std::string name() const override { return "doctor"; }
    std::string summary() const override { return "Check this machine and suggest fixes"; }
    std::string examples() const override {
        return "Nothing is changed. Exit code 0 unless something is missing that run needs.\n"
               "Examples:\n  eventide doctor\n  eventide doctor --json";
    }
    SettingTable settings() override;
    int run(Program& program) override;

private:
    bool json_ = false;
};

}  // namespace eventide::app
