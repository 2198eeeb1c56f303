// The subcommands, in the order --help shows them.
#include "src/app/bench_command.h"
#include "src/app/convert_command.h"
#include "src/app/devices_command.h"
#include "src/app/doctor_command.h"
#include "src/app/evaluate_command.h"
#include "src/app/info_command.h"
#include "src/app/program.h"
#include "src/app/run_command.h"
#include "src/app/simulate_command.h"
#include "src/app/stress_command.h"

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
