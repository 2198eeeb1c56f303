#include "apps/train/training_log.h"

#include "apps/train/curve.h"
#include "src/core/error.h"

#include <fstream>
#include <sstream>

namespace eventide {
namespace {

/// What a new row needs before it: the header of an empty file, and an end of a line that a full
/// disk or a killed run cut short.
std::string before_row(const std::filesystem::path& path, const std::string& header) {
    std::ifstream in{path, std::ios::binary | std::ios::ate};
    if (!in || in.tellg() <= 0) return header + "\n";
    in.seekg(-1, std::ios::end);
    return in.get() == '\n' ? "" : "\n";
}

void append_row(const std::filesystem::path& path, const std::string& header,
                const std::string& row) {
    const std::string before = before_row(path, header);
    std::ofstream out{path, std::ios::app};
    out << before << row << "\n";
    out.flush();
    if (!out) throw Error(ErrorKind::failed, path.string() + ": cannot be written");
}

std::string csv_of_names() {
    std::string text;
    for (const char* name : kLossNames) text += std::string{","} + name;
    return text;
}

}  // namespace

TrainingLog::TrainingLog(std::filesystem::path folder, int every, LogSink say)
    : folder_(std::move(folder)), every_(every), say_(std::move(say)) {}

void TrainingLog::step(const Mark& mark, const LossTerms& terms, const Step& step) {
    const std::size_t n = terms.means.size();
    for (std::size_t k = 0; k < n; ++k) sums_[k] += terms.means[k];
    sums_[n] += step.gradient;
    sums_[n + 1] += step.seconds;
    if (++summed_ < every_) return;
    std::ostringstream row;
    row << mark.step << "," << mark.minutes << "," << step.rate;
    for (const double sum : sums_) row << "," << sum / summed_;
    row << "," << step.skipped;
    append_row(folder_ / "log.csv",
               "step,minutes,rate" + csv_of_names() + ",gradient,seconds,skipped", row.str());
    say_(row.str());
    sums_ = {};
    summed_ = 0;
}

void TrainingLog::validation(const Mark& mark, const Validation::Scores& scores) {
    std::ostringstream row;
    row << mark.step << "," << mark.minutes << "," << scores.score;
    for (const double mean : scores.means) row << "," << mean;
    append_row(folder_ / "validation.csv", "step,minutes,score" + csv_of_names(), row.str());
    say_("validation " + row.str());
    write_curve(folder_ / "learning_curve.svg", folder_ / "log.csv", folder_ / "validation.csv");
}

}  // namespace eventide
