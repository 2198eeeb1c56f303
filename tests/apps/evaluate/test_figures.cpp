// Plots and the figures made with them.
#include "apps/evaluate/figures.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/small_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <regex>

namespace eventide {
namespace {

int count(const std::string& text, const std::string& what) {
    int n = 0;
    for (auto at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++n;
    return n;
}

TEST(Plot, DrawsEachPointOnceAndLeavesOutWhatIsNotFinite) {
    const Plot plot{
        .name = "p",
        .title = "a < b",
        .x_label = "x",
        .y_label = "y",
        .series = {{"one", {1, 2, 3}, {4, NAN, 5}, {.1, .1, .1}}, {"two", {1}, {2}, {}}}};
    const std::string drawn = svg(plot);
    EXPECT_EQ(count(drawn, "<circle"), 3);
    EXPECT_EQ(count(drawn, "<polygon"), 1);
    EXPECT_NE(drawn.find("a &lt; b"), std::string::npos);
    EXPECT_EQ(drawn.find("nan"), std::string::npos);
    EXPECT_EQ(count(csv(plot), "\n"), 5);
    EXPECT_NE(csv(plot).find("\none,2,,0.1\n"), std::string::npos) << csv(plot);
}

TEST(Plot, SurvivesNoPointsOnePointAndLogarithmsOfZero) {
    for (const bool log_x : {false, true})
        for (const auto& x : {std::vector<double>{}, {3.}, {0., 10., 1000.}}) {
            Plot plot{.name = "p", .series = {{"s", x, x, {}}}, .log_x = log_x, .diagonal = true};
            const std::string drawn = svg(plot);
            EXPECT_EQ(count(drawn, "<circle"), int(x.size()));
            EXPECT_EQ(drawn.find("nan"), std::string::npos);
            EXPECT_EQ(drawn.find("inf"), std::string::npos);
        }
}

TEST(Plot, HasItsDiagonalWhereThatPassesThroughItsFrame) {
    Plot plot{.name = "p", .series = {{"s", {.1, .3}, {.2, .4}, {}}}, .diagonal = true};
    EXPECT_EQ(count(svg(plot), "stroke-dasharray"), 1);
    plot.series[0].x = {.01, .02};
    plot.series[0].y = {.3, .35};
    EXPECT_EQ(count(svg(plot), "stroke-dasharray"), 0) << "it would be drawn beside the frame";
}

TEST(Plot, IsFlatWhereValuesDifferByRoundingAlone) {
    const double y = .7, x = 3;
    const Plot plot{.name = "p",
                    .series = {{"s", {x, std::nextafter(x, 4)}, {y, std::nextafter(y, 1)}, {}}}};
    const std::string drawn = svg(plot);
    EXPECT_EQ(count(drawn, "<circle"), 2);
    EXPECT_LT(count(drawn, "text-anchor='end'"), 20) << "ticks of the y axis";
}

std::vector<std::string> ticks_of_x(std::vector<double> x, bool log_x) {
    const std::string drawn = svg(
        {.name = "p", .series = {{"", x, std::vector<double>(x.size(), 1), {}}}, .log_x = log_x});
    const std::regex pattern{"<text x='[0-9.]+' y='364' text-anchor='middle'>([^<]*)<"};
    std::vector<std::string> ticks;
    for (std::sregex_iterator it{drawn.begin(), drawn.end(), pattern}, end; it != end; ++it)
        ticks.push_back((*it)[1]);
    return ticks;
}

TEST(Plot, HasTicksAtRoundNumbers) {
    using Texts = std::vector<std::string>;
    EXPECT_EQ(ticks_of_x({-1, 1.1}, false), (Texts{"-1", "-0.5", "0", "0.5", "1"}));
    EXPECT_EQ(ticks_of_x({0, 60}, false), (Texts{"0", "10", "20", "30", "40", "50", "60"}));
    EXPECT_EQ(ticks_of_x({2, 60}, true), (Texts{"2", "5", "10", "20", "50"}));
    EXPECT_EQ(ticks_of_x({1, 1000}, true), (Texts{"1", "3", "10", "30", "100", "300", "1000"}));
}

TEST(Plot, HasNoTicksOfARangeThatIsEmptyOrEndless) {
    constexpr double kMost = std::numeric_limits<double>::max();
    EXPECT_TRUE(ticks_of_x({-kMost, kMost}, false).empty());
    EXPECT_EQ(ticks_of_x({5, 5}, false).size(), 6U) << "has a width of its own";
    for (const bool log_x : {true, false})
        EXPECT_LT(ticks_of_x({std::numeric_limits<double>::denorm_min(), kMost}, log_x).size(),
                  1300U);
}

/// At 12 px a digit is 6.6 px wide, and the name, which runs upwards, ends at 22.
TEST(Plot, HasRoomForLongNumbersBesideTheNameOfTheirAxis) {
    for (const double base : {.5, .157, -.157}) {
        const Plot plot{.name = "p",
                        .y_label = "mean sigma",
                        .series = {{"s", {1, 2}, {base, base + .0002 * std::abs(base)}, {}}}};
        const std::string drawn = svg(plot), tick = "<text x='([0-9.]+)'[^>]*'end'>([^<]*)<";
        const std::regex pattern{tick};
        for (std::sregex_iterator it{drawn.begin(), drawn.end(), pattern}, end; it != end; ++it)
            EXPECT_GT(std::stod((*it)[1]) - 6.6 * double((*it)[2].length()), 22) << (*it)[2];
    }
}

TEST(Plot, NamesSeriesBesideTheDrawingAndPointsInIt) {
    const Plot plot{.name = "p",
                    .series = {{.label = "AVX2 alone",
                                .x = {1, 2},
                                .y = {1, 2},
                                .labels = {"near", "far"},
                                .joined = false}}};
    const std::string drawn = svg(plot);
    const auto x_of = [&](const std::string& word) {
        const auto end = drawn.find(">" + word + "<");
        return std::stod(drawn.substr(drawn.rfind("<text x='", end) + 9));
    };
    const double width = std::stod(drawn.substr(drawn.find("width='") + 7));
    EXPECT_GT(x_of("AVX2 alone"), x_of("far"));
    EXPECT_GT(x_of("far"), x_of("near"));
    EXPECT_LT(x_of("AVX2 alone"), width);
}

TEST(Plot, NamesOfNearPointsDoNotLieOnEachOther) {
    const Plot plot{.name = "p",
                    .series = {{.label = "s",
                                .x = {1, 1, 1, 2},
                                .y = {1, 1, 1, 2},
                                .labels = {"first", "second", "third", "far"},
                                .joined = false}}};
    const std::string drawn = svg(plot);
    const auto y_of = [&](const std::string& word) {
        const auto end = drawn.find(">" + word + "<");
        return std::stod(drawn.substr(drawn.rfind("y='", end) + 3));
    };
    for (const auto& [one, other] :
         {std::pair{"first", "second"}, {"second", "third"}, {"first", "third"}})
        EXPECT_GT(std::abs(y_of(one) - y_of(other)), 10) << one << " and " << other;
}

TEST(Plot, AMarkIsALineAcrossThatItsLabelNames) {
    const Plot plot{.name = "p",
                    .series = {{"s", {1, 2}, {3, 4}, {}}},
                    .marks = {{10, "a < b"}},
                    .log_x = true};
    const std::string drawn = svg(plot);
    EXPECT_EQ(count(drawn, "stroke-dasharray"), 1);
    EXPECT_NE(drawn.find("a &lt; b"), std::string::npos);
    const auto x_of = [&](const std::string& mark) {
        const auto at = drawn.find(mark);
        return std::stod(drawn.substr(drawn.rfind("x1='", at) + 4));
    };
    EXPECT_GT(x_of("stroke-dasharray"), 300) << "the axis reaches as far as the mark";
}

TEST(Plot, QuotesLabelsThatWouldEndAColumn) {
    const Plot plot{.name = "p",
                    .series = {{"default, 240x180", {1}, {2}, {}}, {"a \"b\"", {1}, {2}, {}}}};
    EXPECT_EQ(csv(plot), "series,x,y,spread\n\"default, 240x180\",1,2,\n\"a \"\"b\"\"\",1,2,\n");
}

TEST(Plot, IsWrittenAsImageAndNumbers) {
    const auto folder = std::filesystem::path{testing::TempDir()} / "eventide_plots";
    const Plot plot{.name = "some", .series = {{"s", {1, 2}, {3, 4}, {}}}};
    EXPECT_EQ(write_plot(plot, folder, true), folder / "some.svg");
    EXPECT_TRUE(std::filesystem::exists(folder / "some.svg"));
    EXPECT_TRUE(std::filesystem::exists(folder / "some.csv"));
    std::ofstream{folder / "file"} << "x";
    EXPECT_THROW(write_plot(plot, folder / "file"), std::exception);
}

FigureSettings small_figures() {
    FigureSettings what;
    what.simulated = small_simulation();
    what.simulated.score_every = 3;
    what.scales = {1, 2};
    what.phases_max = 3;
    what.moving_windows = 4;
    what.silent_windows = {0, 1, 5};
    return what;
}

TEST(Figures, AreEachMadeByTheirName) {
    const EvaluateSettings how = small_model();
    const EvaluateReport report = evaluate_simulated(small_figures().simulated, how);
    for (const std::string& name : figure_names())
        for (const Plot& plot : is_report_figure(name)
                                    ? report_figure(name, report)
                                    : simulated_figure(name, small_figures(), how)) {
            EXPECT_NO_THROW(require_figure(name));
            ASSERT_FALSE(plot.series.empty()) << name;
            for (const Series& series : plot.series) {
                EXPECT_FALSE(series.label.empty() && plot.series.size() > 1);
                EXPECT_EQ(series.x.size(), series.y.size());
                EXPECT_FALSE(series.x.empty()) << plot.name;
            }
        }
    EXPECT_THROW(require_figure("nonsense"), Error);
}

TEST(Figures, OfSequencesTooShortToBeScoredAreRefused) {
    FigureSettings what = small_figures();
    what.simulated.event_windows = what.simulated.skip_frames + what.simulated.score_every - 1;
    for (const char* name : {"spatial", "temporal"})
        EXPECT_THROW(simulated_figure(name, what, small_model()), Error) << name;
    EXPECT_NO_THROW(simulated_figure("silence", what, small_model()));
}

TEST(Figures, OfAReportThatScoredNothingHaveNoPlots) {
    for (const std::string& name : figure_names())
        if (is_report_figure(name)) {
            EXPECT_TRUE(report_figure(name, {}).empty()) << name;
        }
}

const Series& series_of(const std::vector<Plot>& plots, const std::string& plot,
                        const std::string& label) {
    for (const Plot& one : plots)
        for (const Series& series : one.series)
            if (one.name == plot && series.label == label) return series;
    throw std::runtime_error("no series " + label + " in " + plot);
}

TEST(SpatialFigure, ComparesWithCubicWhichIsTheModelItselfAtTheSensorsSize) {
    const auto plots = spatial_super_resolution(small_figures(), small_model());
    const Series& model = series_of(plots, "spatial_mse", "model");
    const Series& cubic = series_of(plots, "spatial_mse", "cubic");
    EXPECT_EQ(model.x, (std::vector<double>{1, 2}));
    EXPECT_EQ(cubic.x, model.x);
    EXPECT_NEAR(cubic.y[0], model.y[0], 1e-7);
    EXPECT_NE(cubic.y[1], model.y[1]);
}

TEST(TemporalFigure, OfOneImagePerFrameIsTheImageAtItsEdge) {
    const auto plots = temporal_super_resolution(small_figures(), small_model());
    const Series& model = series_of(plots, "temporal_mse", "model");
    const Series& blend = series_of(plots, "temporal_mse", "blend of edges");
    EXPECT_EQ(model.x, (std::vector<double>{1, 2, 3}));
    EXPECT_NEAR(blend.y[0], model.y[0], 1e-7);
    EXPECT_NE(blend.y[1], model.y[1]);
}

TEST(SilenceFigure, OfAGatedModelDoesNotChange) {
    const auto plots = error_against_silence(small_figures(), small_model());
    const Series& change = series_of(plots, "silence_change", "model");
    EXPECT_EQ(change.x, (std::vector<double>{0, 1, 5}));
    EXPECT_EQ(change.y[0], 0);
    // The voxel grid of the first silent frame still tells ages, but no gate opens.
    EXPECT_EQ(change.y[2], change.y[1]);
}

}  // namespace
}  // namespace eventide
