#include "apps/train/curve.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace eventide {
namespace {

using Columns = std::map<std::string, std::vector<double>>;

std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> parts;
    std::istringstream in{line};
    for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
    return parts;
}

Columns read_csv(const std::filesystem::path& path) {
    std::ifstream in{path};
    std::string line;
    std::getline(in, line);
    const std::vector<std::string> names = cells(line);
    Columns columns;
    while (std::getline(in, line)) {
        const std::vector<std::string> values = cells(line);
        if (values.size() != names.size()) continue;  // a line cut short by a crash
        for (std::size_t i = 0; i < names.size(); ++i)
            columns[names[i]].push_back(number_in<double>(values[i]).value_or(NAN));
    }
    return columns;
}

constexpr double kWidth = 360, kHeight = 200, kMargin = 40;
constexpr std::array<const char*, 6> kPanels{"l1", "dssim", "lpips", "mse", "nll", "picp80"};

struct Bounds {
    double low = 1e30, high = -1e30;
    void cover(const std::vector<double>& values, std::size_t from = 0) {
        for (std::size_t i = from; i < values.size(); ++i) {
            if (!std::isfinite(values[i])) continue;
            low = std::min(low, values[i]);
            high = std::max(high, values[i]);
        }
    }
    double place(double v) const { return high > low ? (v - low) / (high - low) : 0; }
};

class Panel {
public:
    Panel(const char* name, double x0, double y0, const Columns& log, const Columns& validation)
        : name_(name), x0_(x0), y0_(y0) {
        for (const Columns* columns : {&log, &validation}) {
            if (columns->count(name) == 0) continue;
            // The first lines, before anything is learned, would flatten the rest.
            y_.cover(columns->at(name), columns->at(name).size() / 20);
            x_.cover(columns->at("minutes"));
        }
    }
    void draw(std::ostream& out, const Columns& log, const Columns& validation) const {
        out << "<rect x='" << x0_ << "' y='" << y0_ << "' width='" << kWidth << "' height='"
            << kHeight << "' fill='none' stroke='#888'/>\n";
        out << "<text x='" << x0_ + 6 << "' y='" << y0_ + 14 << "'>" << name_ << "</text>\n";
        if (x_.high < x_.low) return;
        out << "<text x='" << x0_ - 36 << "' y='" << y0_ + 10 << "'>" << y_.high << "</text>\n";
        out << "<text x='" << x0_ - 36 << "' y='" << y0_ + kHeight << "'>" << y_.low << "</text>\n";
        out << "<text x='" << x0_ + kWidth - 60 << "' y='" << y0_ + kHeight + 13 << "'>" << x_.high
            << " min</text>\n";
        curve(out, log, "stroke='#9bd' stroke-width='.7'");
        curve(out, validation, "stroke='#c33' stroke-width='2'");
    }

private:
    void curve(std::ostream& out, const Columns& columns, const char* style) const {
        if (columns.count(name_) == 0) return;
        out << "<polyline fill='none' " << style << " points='";
        const auto &x = columns.at("minutes"), &y = columns.at(name_);
        for (std::size_t i = 0; i < y.size(); ++i) {
            if (!std::isfinite(y[i])) continue;  // a step that was skipped
            out << x0_ + kWidth * x_.place(x[i]) << ","
                << y0_ + kHeight * (1 - std::clamp(y_.place(y[i]), 0.0, 1.0)) << " ";
        }
        out << "'/>\n";
    }
    std::string name_;
    double x0_, y0_;
    Bounds x_, y_;
};

}  // namespace

void write_curve(const std::filesystem::path& svg, const std::filesystem::path& log,
                 const std::filesystem::path& validation) {
    const Columns trained = read_csv(log), judged = read_csv(validation);
    std::ofstream out{svg};
    const double width = 3 * (kWidth + kMargin) + kMargin, height = 2 * (kHeight + kMargin) + 20;
    out << "<svg xmlns='http://www.w3.org/2000/svg' width='" << width << "' height='" << height
        << "' font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' "
           "fill='white'/>\n";
    for (std::size_t i = 0; i < kPanels.size(); ++i) {
        const double x0 = kMargin + double(i % 3) * (kWidth + kMargin);
        const double y0 = 10 + double(i / 3) * (kHeight + kMargin);
        Panel{kPanels[i], x0, y0, trained, judged}.draw(out, trained, judged);
    }
    out << "</svg>\n";
    if (!out) throw Error(ErrorKind::failed, svg.string() + ": cannot be written");
}

}  // namespace eventide
