// What a hard case is, and how long it may take.
#pragma once

#include "apps/cli/stress/pipeline_run.h"

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace eventide::stress {

/// How much of a long case is run: all of it, unless time is short; then as much as there is time
/// for, and the case says how much that was. The quick form knows no clock: it is the same
/// everywhere.
class Budget {
public:
    /// `stopping` ends a case early; may be empty.
    static Budget quick(std::function<bool()> stopping) {
        return Budget{true, 0, std::move(stopping)};
    }
    static Budget minutes(double minutes, std::function<bool()> stopping) {
        return Budget{false, minutes * 60, std::move(stopping)};
    }

    bool is_quick() const { return quick_; }
    const std::function<bool()>& stopping() const { return stopping_; }
    /// The length of a case that is worth cutting.
    template <typename Length>
    Length length(Length whole, Length quick) const {
        return quick_ ? quick : whole;
    }
    /// Answers whether a case that may take this share of all time has to end.
    std::function<bool()> clock(double share) const {
        if (quick_) return [] { return false; };
        const auto end = std::chrono::steady_clock::now() +
                         std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                             std::chrono::duration<double>{share * seconds_});
        return [end, stopping = stopping_] {
            return std::chrono::steady_clock::now() > end || (stopping && stopping());
        };
    }

private:
    Budget(bool quick, double seconds, std::function<bool()> stopping)
        : quick_{quick}, seconds_{seconds}, stopping_{std::move(stopping)} {}
    bool quick_;
    double seconds_;  // for each model
    std::function<bool()> stopping_;
};

struct Bench {
    const Model& model;
    EngineOptions engine;
    Budget budget;

    PipelineRunSettings run_settings() const {
        PipelineRunSettings settings;
        settings.engine = engine;
        settings.stopping = budget.stopping();
        return settings;
    }
    /// The first windows, and later ones now and then.
    Sampling sampling() const { return budget.length(Sampling{}, Sampling{12, 2, 40, 7}); }
};

struct Result {
    std::string happened;
    std::optional<double> error, bound;  ///< in the units the case says; empty: nothing is measured
    bool passed = true;
    bool ran = true;  ///< false: this machine cannot; `happened` says why

    /// Notes what should hold and does not.
    void expect(bool holds, const std::string& what) {
        if (holds) return;
        passed = false;
        happened += "; NOT: " + what;
    }
};

/// The worse of two runs of one case: the first that failed, else that of the larger error.
const Result& worse(const Result& a, const Result& b);

struct Case {
    std::string name;   ///< "hot-pixels"
    std::string title;  ///< for people
    std::function<Result(const Bench&)> run;
    bool of_model = true;       ///< run for each model, else once
    bool in_quick_form = true;  ///< short enough for it
};

/// Float32 against double precision: sums of a few hundred products, each rounded to 6e-8, in
/// numbers near 1; gates keep it from growing. Of codes, intensity and sigma, over the larger of 1
/// and the largest number of the map.
constexpr double kFloatBound = 2e-4;

/// A result with the worst error of codes and frames against double precision, with what always has
/// to hold: no error, finite frames (the pipeline ends with an error at the first that is not),
/// recurrent states within [-1, 1].
Result judged(const PipelineOutcome& outcome, const std::string& happened,
              double bound = kFloatBound);

std::vector<Case> activity_cases();
std::vector<Case> time_cases();
std::vector<Case> window_cases();
std::vector<Case> size_cases();
std::vector<Case> number_cases();
std::vector<Case> agreement_cases();
/// Cases of what may stay open: recordings, outputs, pipelines. The model does not matter.
std::vector<Case> resource_cases();

/// All of them, in the order of the table.
std::vector<Case> all_cases();

}  // namespace eventide::stress
