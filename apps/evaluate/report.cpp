// Three ways to write the same numbers.
#include "apps/evaluate/report.h"

#include "apps/evaluate/csv_field.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>

namespace eventide {
namespace {

using Json = nlohmann::ordered_json;

std::string fixed(std::optional<double> value, int width, int digits) {
    char text[64];
    if (value && std::isfinite(*value))
        std::snprintf(text, sizeof text, "%*.*f", width, digits, *value);
    else
        std::snprintf(text, sizeof text, "%*s", width, "-");
    return text;
}

std::string padded(const std::string& text, std::size_t width) {
    return text + std::string(text.size() < width ? width - text.size() : 1, ' ');
}

/// Enough digits that nothing measured is lost; empty where there is nothing.
std::string exact(std::optional<double> value) {
    if (!value || !std::isfinite(*value)) return "";
    char text[32];
    std::snprintf(text, sizeof text, "%.8g", *value);
    return text;
}

Json number(std::optional<double> value) {
    return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json json_of(const ImageScores& scores) {
    return {{"mse", number(scores.mse)},
            {"ssim", number(scores.ssim)},
            {"lpips", number(scores.lpips)}};
}

Json json_of(const SequenceScores& scores) {
    return {{"sequence", scores.sequence},
            {"frames", scores.frames},
            {"raw", json_of(scores.raw)},
            {"affine", json_of(scores.affine)},
            {"mean_sigma", number(scores.mean_sigma)},
            {"picp80", number(scores.picp80)},
            {"ll", number(scores.ll)},
            {"lpips_corr", number(scores.lpips_corr)},
            {"correlation", number(scores.correlation)}};
}

std::string text_row(const SequenceScores& s, std::size_t name_width) {
    std::string row = padded(s.sequence, name_width);
    char frames[16];
    std::snprintf(frames, sizeof frames, "%6d", s.frames);
    row += frames;
    for (const ImageScores& image : {s.raw, s.affine})
        row += " |" + fixed(image.mse, 7, 4) + fixed(image.ssim, 7, 3) + fixed(image.lpips, 7, 3);
    return row + " |" + fixed(s.picp80, 7, 3) + fixed(s.ll, 8, 2) + fixed(s.lpips_corr, 7, 2) +
           "\n";
}

constexpr const char* kCsvScores =
    "raw_mse,raw_ssim,raw_lpips,affine_mse,affine_ssim,affine_lpips,mean_sigma,picp80,ll,"
    "lpips_corr,correlation\n";

/// The columns of kCsvScores and a comma before them, of a frame or of a sequence.
template <typename Scores>
std::string csv_scores(const Scores& s) {
    std::string row;
    for (const ImageScores& p : {s.raw, s.affine})
        row += "," + exact(p.mse) + "," + exact(p.ssim) + "," + exact(p.lpips);
    for (const auto& each : {s.mean_sigma, s.picp80, s.ll, s.lpips_corr, s.correlation})
        row += "," + exact(each);
    return row + "\n";
}

std::string csv_row(const SequenceScores& s) {
    return csv_field(s.sequence) + "," + std::to_string(s.frames) + csv_scores(s);
}

}  // namespace

SequenceScores overall_scores(const std::vector<SequenceReport>& sequences) {
    std::vector<FrameScores> all;
    for (const SequenceReport& s : sequences)
        all.insert(all.end(), s.frames.begin(), s.frames.end());
    return mean_scores(sequences.size() == 1 ? sequences[0].scores.sequence : "all", all);
}

std::string text_table(const EvaluateReport& report) {
    std::size_t name_width = 12;
    for (const SequenceReport& s : report.sequences)
        name_width = std::max(name_width, s.scores.sequence.size() + 2);
    std::string out = report.subject;
    if (!report.model.empty()) out += ", " + report.model;
    if (!report.settings.empty()) out += ", " + report.settings;
    out += ", " + (report.lpips_name.empty() ? "without LPIPS" : report.lpips_name) + "\n";
    out += std::string(name_width + 6, ' ') +
           " |         raw         |  after affine fit   |         sigma\n";
    out += padded("sequence", name_width) +
           "frames |    mse   ssim  lpips |    mse   ssim  lpips | picp80      ll   corr\n";
    for (const SequenceReport& s : report.sequences) out += text_row(s.scores, name_width);
    if (report.sequences.size() != 1) out += text_row(report.overall, name_width);
    for (const std::string& note : report.notes) out += note + "\n";
    return out;
}

std::string csv(const EvaluateReport& report) {
    std::string out = std::string("sequence,frames,") + kCsvScores;
    for (const SequenceReport& s : report.sequences) out += csv_row(s.scores);
    if (report.sequences.size() != 1) out += csv_row(report.overall);
    return out;
}

std::string frame_csv(const EvaluateReport& report) {
    std::string out = std::string("sequence,time_s,events_per_pixel,") + kCsvScores;
    for (const SequenceReport& s : report.sequences)
        for (const FrameScores& f : s.frames)
            out += csv_field(s.scores.sequence) + "," + exact(f.time_s) + "," +
                   exact(f.events_per_pixel) + csv_scores(f);
    return out;
}

std::string json(const EvaluateReport& report) {
    Json out = json_of(report.overall);
    out["subject"] = report.subject;
    out["model"] = report.model;
    out["lpips_name"] = report.lpips_name;
    out["settings"] = report.settings;
    out["notes"] = report.notes;
    out["sequences"] = Json::array();
    for (const SequenceReport& s : report.sequences) out["sequences"].push_back(json_of(s.scores));
    return out.dump(2, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace eventide
