// The subcommands, in the order --help shows them.
#include "apps/cli/commands/bench_command.h"
#include "apps/cli/commands/convert_command.h"
#include "apps/cli/commands/devices_command.h"
#include "apps/cli/commands/doctor_command.h"
#include "apps/cli/commands/evaluate_command.h"
#include "apps/cli/commands/info_command.h"
#include "apps/cli/commands/run_command.h"
#include "apps/cli/commands/simulate_command.h"
#include "apps/cli/commands/stress_command.h"
#include "apps/cli/program.h"

namespace eventide::app {

std::vector<std::unique_ptr<Command>> all_commands() {
    std::vector<std::unique_ptr<Command>> commands;
    commands.push_back(std::make_unique<RunCommand>());
    commands.push_back(std::make_unique<InfoCommand>());
    commands.push_back(std::make_unique<ConvertCommand>());
    commands.push_back(std::make_unique<DevicesCommand>());
    commands.push_back(std::make_unique<DoctorCommand>());
    commands.push_back(std::make_unique<SimulateCommand>());
    commands.push_back(std::make_unique<EvaluateCommand>());
    commands.push_back(std::make_unique<BenchCommand>());
    commands.push_back(std::make_unique<StressCommand>());
    return commands;
}

}  // namespace eventide::app
