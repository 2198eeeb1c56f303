// eventide run of a part of a recording: where it begins and ends.
#include "tests/system/program_test.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

using Json = nlohmann::json;

class RunPart : public ProgramTest {};

TEST_F(RunPart, BeginsAndEndsWhereItIsTold) {
    ASSERT_EQ(eventide({"run", recording(), "--from", "100ms", "--to", "200ms", "--warmup", "50ms",
                        "--fps", "100", "--out", "a/"})
                  .exit_code,
              0);
    const auto times = column(temp_ / "a/timestamps.csv", 2);
    ASSERT_FALSE(times.empty());
    EXPECT_NEAR(double(times.front()), 100'000, 1000) << "the first event may be a little late";
    EXPECT_NEAR(double(times.size()), 11, 1);
}

TEST_F(RunPart, WritesNoEventsBehindADurationThatBeginsWithTheFirst) {
    const Result result = in_shell(
        "eventide run - --duration 100ms --noise-filter off --out null --events-out a.txt "
        "< recording");
    ASSERT_EQ(result.exit_code, 0) << result.error;
    const Result info = eventide({"info", "a.txt", "--json"});
    const Json json = Json::parse(info.output);
    const double seconds = (json["last_us"].get<double>() - json["first_us"].get<double>()) / 1e6;
    EXPECT_LE(seconds, .1) << "what was read already is left out";
    EXPECT_GT(seconds, .095);
}

TEST_F(RunPart, TheFirstFrameOfAPartIsAsGoodAsThatOfTheWhole) {
    const auto frame_at = [&](const std::string& folder, long long t_us) {
        const auto times = column(temp_ / (folder + "timestamps.csv"), 2);
        const auto found = std::find(times.begin(), times.end(), t_us);
        EXPECT_NE(found, times.end()) << folder << " " << t_us;
        char name[64];
        std::snprintf(name, sizeof name, "frames/frame_%010d.png", int(found - times.begin()));
        return read_text(temp_ / (folder + name));
    };
    const auto run = [&](const std::string& folder, std::vector<std::string> more) {
        std::vector<std::string> all{"run",   recording(), "--window", "20ms",
                                     "--fps", "frame",     "--out",    folder};
        all.insert(all.end(), more.begin(), more.end());
        const Result result = eventide(all);
        ASSERT_EQ(result.exit_code, 0) << result.error;
    };
    run("whole/", {});
    run("part/", {"--from", "200ms", "--to", "300ms"});
    run("cold/", {"--from", "200ms", "--to", "300ms", "--warmup", "0s"});
    // It began where the whole run did, and saw all that it saw.
    const long long t = column(temp_ / "part/timestamps.csv", 2).front();
    EXPECT_EQ(frame_at("part/", t), frame_at("whole/", t));
    const long long cold = column(temp_ / "cold/timestamps.csv", 2).front();
    EXPECT_NE(read_text(temp_ / "cold/frames/frame_0000000000.png"), frame_at("part/", t)) << cold;
}

TEST_F(RunPart, TheFirstAndTheLastEventAreInTheirOwnFrames) {
    write_text(temp_ / "e.txt", "8 8\n0.100000 1 2 1\n0.150000 3 4 0\n0.200000 5 6 1\n");
    for (const char* from : {"0s", "@150000", "100ms", "@200000"}) {
        const Result result =
            eventide({"run", "e.txt", "--from", from, "--out", "a/", "--overwrite"});
        EXPECT_EQ(result.exit_code, 0) << result.error;
        const auto events = column(temp_ / "a/timestamps.csv", 5);
        ASSERT_FALSE(events.empty()) << from;
        EXPECT_GE(events.front(), 1) << from;
    }
    EXPECT_EQ(
        eventide({"run", "e.txt", "--from", "@200000", "--to", "@200000", "--out", "b/"}).exit_code,
        0);
    EXPECT_EQ(column(temp_ / "b/timestamps.csv", 2), (std::vector<long long>{200'000}));
}

}  // namespace
}  // namespace eventide::test
