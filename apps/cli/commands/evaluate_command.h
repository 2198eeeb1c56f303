// eventide evaluate: how good a model's frames and sigma are.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/settings/run_settings.h"
#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/figures.h"
#include "src/settings/values.h"

namespace eventide::app {

class EvaluateCommand : public Command {
public:
    std::string name() const override { return "evaluate"; }
    std::string summary() const override {
        return "Measure a model against reference images or simulated truth";
    }
    std::string examples() const override;
    std::vector<Positional> positionals() override;
    SettingTable settings() override;
    int run(Program& program) override;

private:
    enum class Protocol { recordings, evreal, simulated, folders };
    static inline const std::vector<Word<Protocol>> kProtocolWords{
        {Protocol::recordings, "recordings"},
        {Protocol::evreal, "evreal"},
        {Protocol::simulated, "simulated"},
        {Protocol::folders, "folders"}};

    EvaluateSettings how(Program& program) const;
    SimulatedSettings simulated() const;
    EvaluateReport evaluate(const EvaluateSettings& how) const;
    void require_inputs() const;
    void require_figures_that_fit() const;
    void require_outputs_that_fit() const;
    bool evaluates() const;
    bool simulates() const;
    static std::vector<Protocol> protocols_of(const std::string& key);
    void refuse_idle_flags(const FlagKeys& flags) const;
    void refuse_flags_of_other_formats(const FlagKeys& flags) const;
    void name_evaluation_files(const EvaluateSettings& how, NamedFiles& files) const;
    void name_plots(NamedFiles& files) const;
    void write_plots(const std::vector<Plot>& plots) const;
    void write_report_figures(const EvaluateReport& report) const;
    void make_simulated_figures(const EvaluateSettings& how) const;
    bool has_standard_output() const;
    void write(const EvaluateReport& report, const Signals& signals) const;
    void calibrate(const EvaluateReport& report, const EvaluateSettings& how) const;

    std::vector<std::string> inputs_;
    InputSettings input_;
    Protocol protocol_ = Protocol::recordings;
    std::string model_ = "default", lpips_, window_ = "reference";
    int lookahead_ = 0, skip_ = 3, given_images_ = 0, threads_ = 0, self_ensemble_ = 1;
    SigmaChoice sigma_rule_;
    std::string noise_filter_ = "model";
    std::string lamp_flicker_ = "auto";
    Precision precision_ = Precision::automatic;
    Engine engine_ = Engine::fast;
    std::optional<ColourFilter> bayer_;
    std::string from_ = "start", to_ = "end";
    std::string images_;
    int last_images_ = 0, sequences_ = 20, event_windows_ = 150, seed_ = 4000;
    Size size_{240, 160};
    double scale_ = 1;
    std::string json_, csv_, frame_csv_;
    std::vector<std::string> figures_;
    static constexpr const char* kPlots = "plots";  // where nothing else is said
    std::string plots_ = kPlots;
    CalibrationRule calibration_ = CalibrationRule::coverage;
    std::string calibrated_;
    bool overwrite_ = false;
};

}  // namespace eventide::app
