// Axes, ticks at round numbers, lines, a legend: no more than the figures need.
#include "apps/evaluate/plot.h"

#include "apps/evaluate/csv_field.h"
#include "src/io/output_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

namespace eventide {
namespace {

// Of the drawing; the legend stands to the right of it.
constexpr double kWidth = 640, kHeight = 400, kLeft = 72, kRight = 16, kTop = 36, kBottom = 52;
constexpr double kName = 24, kTickGap = 6;  // of the y axis
constexpr double kLegendMark = 28, kCharacterWidth = 6.6;
constexpr std::array<const char*, 6> kColours{"#1b6ca8", "#d1495b", "#2e8b57",
                                              "#8a5cb8", "#c77d0a", "#555555"};

std::string number(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", v);
    return text;
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text)
        out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : c == '>' ? "&gt;" : std::string(1, c);
    return out;
}

/// One axis: data to pixels.
struct Axis {
    double low = 0, high = 1, from = 0, to = 1;
    bool logarithmic = false;

    double scaled(double v) const { return logarithmic ? std::log10(std::max(v, low)) : v; }
    double at(double v) const {
        const double a = scaled(low), b = scaled(high);
        return from + (to - from) * (b > a ? (scaled(v) - a) / (b - a) : .5);
    }
    /// None where the range is empty or endless.
    std::vector<double> ticks() const {
        if (!(high > low) || !std::isfinite(high - low)) return {};
        return logarithmic ? ticks_of_decades() : even_ticks();
    }

private:
    std::vector<double> ticks_of_decades() const {
        if (low <= 0) return {};
        const bool wide = high > 100 * low;
        const int first = int(std::floor(std::log10(low))), last = int(std::ceil(std::log10(high)));
        std::vector<double> out;
        for (int decade = first; decade <= last; ++decade)
            for (const double m : wide ? std::vector{1., 3.} : std::vector{1., 2., 5.})
                if (const double v = m * std::pow(10, decade); v >= low * .999 && v <= high * 1.001)
                    out.push_back(v);
        return out;
    }
    std::vector<double> even_ticks() const {
        constexpr double kMost = 12;  // of steps of a sixth of the range, rounded
        const double rough = (high - low) / 6, power = std::pow(10, std::floor(std::log10(rough)));
        const double m = rough / power;
        const double step = power * (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10);
        if (!(step > 0)) return {};
        const double first = std::ceil(low / step), last = std::floor(high / step + 1e-6);
        std::vector<double> out;
        for (int i = 0, count = int(std::min(last - first + 1, kMost)); i < count; ++i)
            out.push_back((first + i) * step);
        return out;
    }
};

struct Axes {
    Axis x, y;
};

bool has_labels(const Plot& plot) {
    return !plot.marks.empty() ||
           std::ranges::any_of(plot.series, [](const Series& s) { return !s.labels.empty(); });
}

/// No higher than rounding makes it: ticks would not add up to its height.
bool is_flat(double low, double high) {
    return high - low <= 1e-9 * std::max(std::abs(low), std::abs(high));
}

Axes axes_of(const Plot& plot) {
    double x0 = std::numeric_limits<double>::max(), x1 = std::numeric_limits<double>::lowest();
    double y0 = x0, y1 = x1;
    for (const Series& s : plot.series)
        for (std::size_t i = 0; i < s.x.size(); ++i) {
            if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) continue;
            if (plot.log_x && s.x[i] <= 0) continue;
            const double spread = i < s.spread.size() ? s.spread[i] : 0;
            x0 = std::min(x0, s.x[i]);
            x1 = std::max(x1, s.x[i]);
            y0 = std::min(y0, s.y[i] - spread);
            y1 = std::max(y1, s.y[i] + spread);
        }
    for (const VerticalLine& mark : plot.marks) {
        x0 = std::min(x0, mark.x);
        x1 = std::max(x1, mark.x);
    }
    if (x0 > x1) x0 = plot.log_x ? 1 : 0, x1 = plot.log_x ? 10 : 1, y0 = 0, y1 = 1;
    if (y0 > 0 && y0 < .6 * y1) y0 = 0;  // show zero where it is near
    if (is_flat(y0, y1)) y0 = std::min(0., y0), y1 = y1 > 0 ? 1.25 * y1 : y0 + 1;
    if (is_flat(x0, x1)) x1 = x0 + 1;
    if (has_labels(plot)) {  // room beside the outermost points
        const double room = plot.log_x ? std::pow(x1 / x0, .12) : .12 * (x1 - x0);
        x0 = plot.log_x ? x0 / std::sqrt(room) : x0 - room / 4;
        x1 = plot.log_x ? x1 * room : x1 + room;
    }
    const double margin = .04 * (y1 - y0);
    Axes axes{{x0, x1, kLeft, kWidth - kRight, plot.log_x},
              {y0 == 0 ? 0 : y0 - margin, y1 + margin, kHeight - kBottom, kTop, false}};
    for (const double v : axes.y.ticks())  // room for long numbers beside the axis' name
        axes.x.from =
            std::max(axes.x.from, kName + kCharacterWidth * double(number(v).size()) + kTickGap);
    return axes;
}

std::string line(double x1, double y1, double x2, double y2, const std::string& style) {
    return "<line x1='" + number(x1) + "' y1='" + number(y1) + "' x2='" + number(x2) + "' y2='" +
           number(y2) + "' " + style + "/>\n";
}

std::string text(double x, double y, const std::string& what, const std::string& style) {
    return "<text x='" + number(x) + "' y='" + number(y) + "' " + style + ">" + escaped(what) +
           "</text>\n";
}

std::string frame_of(const Plot& plot, const Axes& axes) {
    std::string out;
    const double left = axes.x.from, right = axes.x.to;
    for (const double v : axes.x.ticks()) {
        const double x = axes.x.at(v);
        out += line(x, kTop, x, kHeight - kBottom, "stroke='#e4e4e4'");
        out += text(x, kHeight - kBottom + 16, number(v), "text-anchor='middle'");
    }
    for (const double v : axes.y.ticks()) {
        const double y = axes.y.at(v);
        out += line(left, y, right, y, "stroke='#e4e4e4'");
        out += text(left - kTickGap, y + 4, number(v), "text-anchor='end'");
    }
    out += text((left + right) / 2, 22, plot.title, "text-anchor='middle' font-weight='bold'");
    out += text((left + right) / 2, kHeight - 14, plot.x_label, "text-anchor='middle'");
    const double middle = (kTop + kHeight - kBottom) / 2;
    return out + text(18, middle, plot.y_label,
                      "text-anchor='middle' transform='rotate(-90 18 " + number(middle) + ")'");
}

/// Where labels of points stand, so that none lies on another.
class LabelPlaces {
public:
    static double width(const std::string& label) { return 5.8 * double(label.size()); }

    /// The base line of a label for the point at (x, y): above it, below it, or further away.
    double place(double x, double y, const std::string& label) {
        constexpr double kHeightOfLine = 11;  // at font size 10
        Box box{x, x + width(label), 0};
        for (const double offset : {-5., 13., -16., 24., -27., 35., -38., 46.}) {
            box.y = y + offset;
            const bool free = std::ranges::none_of(taken_, [&](const Box& other) {
                return box.x0 < other.x1 && other.x0 < box.x1 &&
                       std::abs(box.y - other.y) < kHeightOfLine;
            });
            if (free && box.y > kTop + kHeightOfLine && box.y < kHeight - kBottom) break;
        }
        taken_.push_back(box);
        return box.y;
    }

private:
    struct Box {
        double x0, x1, y;
    };
    std::vector<Box> taken_;
};

std::string drawn(const Series& s, const Axes& axes, const std::string& colour,
                  LabelPlaces& places) {
    std::string path, above, below, dots;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
        if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) continue;
        const std::string x = number(axes.x.at(s.x[i])), y = number(axes.y.at(s.y[i]));
        path += x + "," + y + " ";
        dots += "<circle cx='" + x + "' cy='" + y + "' r='2.5' fill='" + colour + "'/>\n";
        if (i < s.labels.size())
            dots += text(axes.x.at(s.x[i]) + 5,
                         places.place(axes.x.at(s.x[i]) + 5, axes.y.at(s.y[i]), s.labels[i]),
                         s.labels[i], "font-size='10' fill='" + colour + "'");
        if (i >= s.spread.size()) continue;
        above += x + "," + number(axes.y.at(s.y[i] + s.spread[i])) + " ";
        below = x + "," + number(axes.y.at(s.y[i] - s.spread[i])) + " " + below;
    }
    std::string out;
    if (!above.empty())
        out += "<polygon points='" + above + below + "' fill='" + colour + "' opacity='.15'/>\n";
    if (s.joined)
        out += "<polyline points='" + path + "' fill='none' stroke='" + colour +
               "' stroke-width='1.8'/>\n";
    return out + dots;
}

/// Its label stands to the left: beyond the last may be no room.
std::string drawn(const VerticalLine& mark, const Axes& axes, LabelPlaces& places) {
    const double x = axes.x.at(mark.x);
    const double y = places.place(x - 5 - LabelPlaces::width(mark.label), kTop + 8, mark.label);
    return line(x, kTop, x, kHeight - kBottom, "stroke='#888' stroke-dasharray='5 4'") +
           text(x - 5, y, mark.label, "text-anchor='end' font-size='10' fill='#666'");
}

/// Pixels beside the drawing that the labels of its series need; 0 where a title says it all.
double legend_width(const Plot& plot) {
    std::size_t longest = 0;
    for (const Series& s : plot.series) longest = std::max(longest, s.label.size());
    return longest == 0 ? 0 : kLegendMark + 12 + kCharacterWidth * double(longest);
}

std::string legend_of(const Plot& plot) {
    std::string out;
    double y = kTop + 10;
    for (std::size_t i = 0; i < plot.series.size(); ++i, y += 18) {
        const std::string colour = "'" + std::string(kColours[i % kColours.size()]) + "'";
        if (plot.series[i].joined)
            out +=
                line(kWidth, y - 4, kWidth + 18, y - 4, "stroke=" + colour + " stroke-width='2'");
        else
            out += "<circle cx='" + number(kWidth + 9) + "' cy='" + number(y - 4) +
                   "' r='3' fill=" + colour + "/>\n";
        out += text(kWidth + kLegendMark, y, plot.series[i].label, "");
    }
    return out;
}

}  // namespace

std::string svg(const Plot& plot) {
    const Axes axes = axes_of(plot);
    std::string out = "<svg xmlns='http://www.w3.org/2000/svg' width='" +
                      number(kWidth + legend_width(plot)) + "' height='" + number(kHeight) +
                      "' font-family='sans-serif' font-size='12'>\n"
                      "<rect width='100%' height='100%' fill='white'/>\n" +
                      frame_of(plot, axes);
    const double low = std::max(axes.x.low, axes.y.low);
    if (const double high = std::min(axes.x.high, axes.y.high); plot.diagonal && low < high)
        out += line(axes.x.at(low), axes.y.at(low), axes.x.at(high), axes.y.at(high),
                    "stroke='#888' stroke-dasharray='5 4'");
    LabelPlaces places;
    for (const VerticalLine& mark : plot.marks) out += drawn(mark, axes, places);
    for (const bool joined : {true, false})  // points over lines
        for (std::size_t i = 0; i < plot.series.size(); ++i)
            if (plot.series[i].joined == joined)
                out += drawn(plot.series[i], axes, kColours[i % kColours.size()], places);
    return out + legend_of(plot) + "</svg>\n";
}

std::string csv(const Plot& plot) {
    const auto cell = [](double v) { return std::isfinite(v) ? number(v) : ""; };
    std::string out = "series,x,y,spread\n";
    for (const Series& s : plot.series)
        for (std::size_t i = 0; i < s.x.size(); ++i)
            out += csv_field(s.label) + "," + cell(s.x[i]) + "," + cell(s.y[i]) + "," +
                   (i < s.spread.size() ? cell(s.spread[i]) : "") + "\n";
    return out;
}

std::filesystem::path write_plot(const Plot& plot, const std::filesystem::path& folder,
                                 bool overwrite) {
    create_folder(folder);
    std::filesystem::path drawing = folder / (plot.name + ".svg");
    write_file(folder / (plot.name + ".csv"), csv(plot), overwrite);
    write_file(drawing, svg(plot), overwrite);
    return drawing;
}

}  // namespace eventide
