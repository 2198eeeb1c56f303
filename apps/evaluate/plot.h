// Line plots as SVG, and the same numbers as CSV.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

struct Series {
    std::string label{};
    std::vector<double> x{}, y{};
    std::vector<double> spread{};       ///< standard deviation, drawn as a band; empty: none
    std::vector<std::string> labels{};  ///< beside the points; empty: none
    bool joined = true;                 ///< by lines; else points alone
};

/// A vertical line across the drawing: what has an x and no y.
struct VerticalLine {
    double x = 0;
    std::string label{};
};

struct Plot {
    std::string name{};  ///< of the files
    std::string title{}, x_label{}, y_label{};
    std::vector<Series> series{};
    std::vector<VerticalLine> marks{};
    bool log_x = false;     ///< points with x <= 0 are drawn at the left edge
    bool diagonal = false;  ///< what would be perfect: y = x
};

/// Points that are not finite are left out.
std::string svg(const Plot& plot);

/// Columns series, x, y, spread; empty for what is not finite.
std::string csv(const Plot& plot);

/// Writes folder/name.svg and folder/name.csv and returns the first. Throws Error: failed, or usage
/// for a file that is there and may not be replaced.
std::filesystem::path write_plot(const Plot& plot, const std::filesystem::path& folder,
                                 bool overwrite = false);

}  // namespace eventide
