// eventide bench: how fast, and how good, on this machine.
#pragma once

#include "apps/bench/activity.h"
#include "apps/bench/stages.h"
#include "apps/cli/bench/bench_settings.h"
#include "apps/cli/bench/bench_table.h"
#include "apps/cli/command.h"
#include "apps/cli/commands/recording_in_memory.h"
#include "apps/cli/settings/run_settings.h"
#include "src/settings/values.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide::app {

class BenchCommand : public Command {
public:
    std::string name() const override { return "bench"; }
    std::string summary() const override {
        return "Speed against error on this machine, one table";
    }
    std::string examples() const override;
    SettingTable settings() override;
    int run(Program& program) override;

private:
    void add_measured(SettingTable& table);
    void add_outputs(SettingTable& table);
    /// Calls measure(name, model, windows, settings) for each size, model and precision.
    template <typename Measure>
    void for_each_stage(const std::string& what, Program& program, const Measure& measure) const;
    BenchRow measure(const std::shared_ptr<const RecordedPackets>& data, const std::string& model,
                     Precision precision, Program& program) const;
    /// Each size, model and precision: the stages alone.
    std::vector<bench::StageRow> measure_stages(const bench::Peaks& peaks, Program& program) const;
    /// The same: what a part of the scene that moves costs.
    std::vector<bench::ActivityRow> measure_activity(Program& program) const;
    /// The same: the pipeline.
    std::vector<BenchRow> measure_pipelines(Program& program) const;
    int report(Program& program) const;
    void name_bench_files(NamedFiles& files) const;
    void check_cases() const;

    BenchSettings settings_;
    std::string json_, plots_, report_, peers_;

    bool stages_ = false, activity_ = false, overwrite_ = false;
};

}  // namespace eventide::app
