// eventide bench, as a user runs it.
#include "tests/system/commands_test.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace eventide::test {
namespace {

using testing::HasSubstr;

TEST_F(Commands, BenchPrintsTheMachineAndARowForEachSize) {
    const Result result = eventide({"bench", "--seconds", "0.3", "--sizes", "32x24", "--sizes",
                                    "48x32", "--json", "bench.json"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_NE(result.output.find("48x32"), std::string::npos);
    const Json json = Json::parse(read_text(temp_ / "bench.json"));
    ASSERT_EQ(json["rows"].size(), 2U);
    EXPECT_GT(json["rows"][0]["mse"].get<double>(), 0);
    EXPECT_GT(json["rows"][0]["times_real_time"].get<double>(), 0);
}

TEST_F(Commands, BenchReportsSpeedAgainstErrorInOnePage) {
    const std::vector<std::string> command{
        "bench",     "--report", "report",       "--sizes", "32x24",          "--seconds", "0.2",
        "--threads", "1",        "--precisions", "f32",     "--instructions", "avx2"};
    const Result result = eventide(command);
    ASSERT_EQ(result.exit_code, 0) << result.error;
    const Json json = Json::parse(read_text(temp_ / "report/report.json"));
    ASSERT_GE(json["speed"].size(), 4U);  // of one arithmetic at least, and of three other windows
    bool has_front = false;
    for (const Json& row : json["speed"]) {
        EXPECT_GT(row["mse"].get<double>(), 0);
        EXPECT_GT(row["encode_ms"].get<double>(), 0);
        has_front |= row["front"].get<bool>();
        EXPECT_EQ(row["engine"].get<std::string>().find("bf16"), std::string::npos);
    }
    EXPECT_TRUE(has_front);
    EXPECT_EQ(json["settings"], "scene demo, lookahead 2, threads 1, instructions avx2");
    EXPECT_LT(json["speed"][0]["codes_rms_of_range"].get<double>(), 1e-5);
    EXPECT_EQ(json["loads"].size(), 7U);
    EXPECT_GT(json["memory"][0]["resident_mib"].get<double>(), 1);
    const std::string page = read_text(temp_ / "report/index.html");
    EXPECT_NE(page.find("<svg"), std::string::npos);
    for (const char* outside : {"src=", "href=", "@import", "url("})
        EXPECT_EQ(page.find(outside), std::string::npos) << outside;
    EXPECT_EQ(eventide(command).exit_code, 2);  // nothing is replaced unasked
}

TEST_F(Commands, BenchMeasuresTheStagesAlone) {
    const Result result = eventide({"bench", "--stages", "--sizes", "32x24", "--precisions", "f32",
                                    "--instructions", "sse4", "--json", "-"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, HasSubstr("encode, cpu ms")) << "the table does not mix with data";
    const Json json = Json::parse(result.output);
    EXPECT_TRUE(json["rows"].empty()) << "the pipeline ran too";
    ASSERT_EQ(json["stages"].size(), 1U);
    const Json& row = json["stages"][0];
    EXPECT_EQ(row["engine"], "fast, SSE4");
    EXPECT_EQ(row["peak_bf16_gflops"], 0) << "not allowed to such a processor";
    for (const char* key : {"encode_ms", "render_fresh_ms", "render_again_ms", "bin_mev_s"})
        EXPECT_GT(row[key].get<double>(), 0) << key;
    EXPECT_EQ(eventide({"bench", "--stages", "--repetitions", "3"}).exit_code, 2);
}

TEST_F(Commands, BenchMeasuresAsOnAnOlderProcessor) {
    const auto engine_with = [&](const std::string& instructions) {
        const Result result =
            eventide({"bench", "--seconds", "0.2", "--sizes", "32x24", "--precisions", "f32",
                      "--instructions", instructions, "--json", "bench.json", "--overwrite"});
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return Json::parse(read_text(temp_ / "bench.json"))["rows"][0]["engine"];
    };
    EXPECT_EQ(engine_with("sse4"), "fast, SSE4");
    EXPECT_NE(engine_with("best"), "fast, SSE4") << "expected a processor with AVX2 or NEON";
    EXPECT_EQ(eventide({"bench", "--instructions", "mmx"}).exit_code, 2);
}

}  // namespace
}  // namespace eventide::test
