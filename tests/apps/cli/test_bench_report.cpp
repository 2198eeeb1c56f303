// The report of speed against error, of rows that nobody had to measure.
#include "apps/cli/bench/bench_table.h"
#include "apps/cli/bench/report.h"
#include "apps/cli/settings/words.h"
#include "src/core/error.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace eventide::app {
namespace {

SpeedRow row(const std::string& model, const Size& sensor, double ms, double mse) {
    SpeedRow made;
    made.model = model;
    made.sensor = sensor;
    made.encode_ms = .75 * ms;
    made.render_ms = .25 * ms;
    made.error.raw.mse = mse;
    return made;
}

TEST(BenchReport, OnTheFrontIsWhatNothingOfItsSizeBeatsInBoth) {
    const Size small{64, 48}, large{640, 480};
    std::vector<SpeedRow> rows{row("quick", small, 1, .04), row("good", small, 4, .02),
                               row("beaten", small, 5, .03), row("alike", small, 4, .02),
                               row("alone", large, 50, .5)};
    mark_front(rows);
    std::vector<bool> front;
    for (const SpeedRow& each : rows) front.push_back(each.is_on_front);
    EXPECT_EQ(front, (std::vector<bool>{true, true, false, true, true}));
}

/// Their engine's word, precision and instructions, as "fast f32 avx2".
std::vector<std::string> named(const std::vector<EngineOptions>& engines) {
    std::vector<std::string> names;
    for (const EngineOptions& each : engines)
        names.push_back(show_word(each.engine, kEngineWords) + " " +
                        show_word(each.precision, kPrecisionWords) + " " +
                        show_word(each.instructions, kInstructionWords));
    return names;
}

TEST(BenchReport, ComparesTheArithmeticThatWasAskedForAndThatTheProcessorHas) {
    using Names = std::vector<std::string>;
    bench::Peaks peaks{.f32_avx2 = 100, .f32_avx512 = 120, .bf16 = 240};
    BenchSettings settings;
    EXPECT_EQ(named(engines_of(settings, peaks)),
              (Names{"fast f32 avx2", "fast f32 best", "fast bf16 best"}));
    settings.precisions = {"f32"};
    EXPECT_EQ(named(engines_of(settings, peaks)), (Names{"fast f32 avx2", "fast f32 best"}));
    settings.precisions = {"bf16"};
    EXPECT_EQ(named(engines_of(settings, peaks)), (Names{"fast bf16 best"}));
    settings.precisions = {"bf16", "f32"};
    settings.instructions = Instructions::avx512;
    EXPECT_EQ(named(engines_of(settings, peaks)),
              (Names{"fast f32 avx2", "fast f32 avx512", "fast bf16 avx512"}));
    peaks = {.f32_sse4 = 50};
    settings.precisions = {"auto"};
    settings.instructions = Instructions::sse4;
    EXPECT_EQ(named(engines_of(settings, peaks)), (Names{"fast f32 sse4"}));
    settings.engine = Engine::plain;
    EXPECT_EQ(named(engines_of(settings, peaks)), (Names{"plain auto best"}));
}

TEST(BenchTable, HasADashWhereFramesHaveNoTruthOfTheirSize) {
    testing::internal::CaptureStdout();
    print_bench_table({{.model = "default", .engine = {}, .sensor = {}, .mse = std::nan("")},
                       {.model = "small", .engine = {}, .sensor = {}, .mse = .0123}},
                      stdout);
    const std::string table = testing::internal::GetCapturedStdout();
    EXPECT_NE(table.find(" -\n"), std::string::npos) << table;
    EXPECT_NE(table.find(" 0.0123\n"), std::string::npos) << table;
}

TEST(BenchReport, WritesTheFilesItSaysAndNamesCannotBreakThePage) {
    const test::TempFolder temp;
    Report report;
    report.machine = "a <b> & \x1b[31m";
    report.speed = {row("<script>", {64, 48}, 1, .04)};
    write_report(report, temp.path() / "made", false);
    std::set<std::filesystem::path> there, said;
    for (const auto& entry : std::filesystem::directory_iterator(temp.path() / "made"))
        there.insert(entry.path().filename());
    for (const auto& file : report_files()) said.insert(file);
    EXPECT_EQ(there, said);
    std::ifstream file(temp.path() / "made/index.html");
    std::stringstream page;
    page << file.rdbuf();
    EXPECT_EQ(page.str().find("<script>"), std::string::npos);
    EXPECT_EQ(page.str().find('\x1b'), std::string::npos);
    EXPECT_NE(page.str().find("a &lt;b&gt; &amp; "), std::string::npos);
    EXPECT_THROW(write_report(report, temp.path() / "made", false), std::exception);
}

TEST(BenchReport, ShowsOtherNetworksAndRefusesWhatIsNoTableOfThem) {
    const test::TempFolder temp;
    const std::string head = "network\tengine\t...\n";
    test::write_text(temp / "peers",
                     head + "FireNet\tlibtorch, f32\tAVX2\t240\t180\t1\t46.5\t47\n");
    Report report;
    report.peers = read_peers(temp / "peers");
    ASSERT_EQ(report.peers.size(), 1U);
    EXPECT_EQ(report.peers[0].engine, "libtorch, f32");
    EXPECT_EQ(report.peers[0].wall_ms, 47);
    EXPECT_NE(page_of(report).find("<td>FireNet</td>"), std::string::npos);
    EXPECT_NE(page_of(report).find(">FireNet, 240x180</text>"), std::string::npos);
    EXPECT_TRUE(read_peers("").empty());
    for (const char* bad : {"FireNet\tx\tAVX2\t240\t180\t1\n", "a\tb\tc\t0\t1\t1\t1\t1\n",
                            "a\tb\tc\t1\t1\t1\t1\tx\n"}) {
        test::write_text(temp / "bad", head + bad);
        EXPECT_THROW(read_peers(temp / "bad"), Error) << bad;
    }
    EXPECT_THROW(read_peers(temp / "none"), Error);
}

}  // namespace
}  // namespace eventide::app
