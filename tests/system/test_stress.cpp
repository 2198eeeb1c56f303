// The quick form of eventide stress: every hard case with every shipped model.
#include "tests/system/program_test.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>

namespace eventide::test {
namespace {

using Json = nlohmann::json;

class Stress : public ProgramTest {
protected:
    ProcessSettings shipped() const {
        return {.environment = {{"EVENTIDE_MODELS", EVENTIDE_SOURCE_DIR "/config/models"}}};
    }
};

class StressOf : public Stress, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Models, StressOf, testing::Values("default", "small", "thesis"),
                         [](const auto& of) { return std::string{of.param}; });

TEST_P(StressOf, HoldsInEveryCase) {
    const Result result =
        eventide({"stress", "--quick", "--models", GetParam(), "--json", "cases.json"}, shipped());
    const Json json = Json::parse(read_text(temp_ / "cases.json"));
    EXPECT_GE(json["rows"].size(), 35U);
    for (const Json& row : json["rows"])
        EXPECT_EQ(row["verdict"], "passed") << row["title"] << ": " << row["happened"];
    EXPECT_EQ(result.exit_code, 0);
}

TEST_F(Stress, IsDoneWithZeroWhereEveryCasePasses) {
    const Result result = eventide(
        {"stress", "--quick", "--cases", "on[e-]*", "--models", "small", "--models", "default"},
        shipped());
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_NE(result.output.find("| one event | default |"), std::string::npos) << result.output;
    EXPECT_NE(result.output.find("6 rows, 0 failed"), std::string::npos) << result.output;
}

TEST_F(Stress, TellsTheSameTableEachTime) {
    const std::vector<std::string> arguments{"stress", "--quick",  "--cases",
                                             "one-*",  "--models", "small"};
    EXPECT_EQ(eventide(arguments, shipped()).output, eventide(arguments, shipped()).output);
}

TEST_F(Stress, AnUnknownCaseIsWrongUsageAndListNamesTheKnownOnes) {
    const Result unknown = eventide({"stress", "--cases", "nonsense"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.error.find("--list"), std::string::npos) << unknown.error;
    const Result list = eventide({"stress", "--list"});
    EXPECT_EQ(list.exit_code, 0);
    for (const char* name : {"silence", "hot-pixels", "sensor-4096x4096", "open-sinks"})
        EXPECT_NE(list.output.find(name), std::string::npos) << name;
}

TEST_F(Stress, SoakWatchesMemoryLatencyAndStates) {
    const Result result = eventide({"stress", "--soak", "0.01", "--models", "default", "--plots",
                                    "plots", "--json", "soak.json"},
                                   shipped());
    // Whether memory and latency were flat in so short a time is for longer ones to say.
    EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 1) << result.error;
    EXPECT_NE(result.output.find("states within"), std::string::npos) << result.output;
    for (const char* name : {"soak_memory", "soak_latency", "soak_state"})
        EXPECT_NE(read_text(temp_ / ("plots/" + std::string{name} + ".svg")).find("<svg"),
                  std::string::npos);
    EXPECT_EQ(Json::parse(read_text(temp_ / "soak.json"))["rows"][0]["case"], "soak");
}

}  // namespace
}  // namespace eventide::test
