// eventide stress: hard cases through the whole pipeline, in one table.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/stress/stress_case.h"
#include "src/core/instructions.h"

#include <string>
#include <vector>

namespace eventide::app {

class StressCommand : public Command {
public:
    std::string name() const override { return "stress"; }
    std::string summary() const override { return "Run hard cases against double precision"; }
    std::string examples() const override;
    SettingTable settings() override;
    int run(Program& program) override;

private:
    int run_cases(Program& program);
    int run_soak(Program& program);
    void name_stress_files(NamedFiles& files) const;
    stress::Budget budget(Program& program) const;
    std::vector<stress::Case> chosen() const;

    std::vector<std::string> models_{"default", "small", "thesis"};
    std::string cases_ = "*", json_, plots_;
    double minutes_ = 5, soak_hours_ = 0;
    int threads_ = 0;
    bool quick_ = false, list_ = false, overwrite_ = false;
    Instructions instructions_ = Instructions::best;
};

}  // namespace eventide::app
