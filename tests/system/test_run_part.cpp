// eventide run of a part of a recording: where it begins and ends.
#include "tests/system/program_test.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
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

std::string words(const std::vector<std::uint32_t>& values) {
    std::string bytes;
    for (const std::uint32_t value : values)
        for (int shift = 0; shift < 32; shift += 8) bytes += char(value >> shift);
    return bytes;
}

/// AEDAT 3.1, times in ms: 400 events 1 ms apart from each of two on; before the second the clock
/// was reset.
std::string two_clocks(std::uint32_t first_ms, std::uint32_t second_ms) {
    std::string bytes = "#!AER-DAT3.1\r\n#Format: RAW\r\n#Source 1: DVS128\r\n#!END-HEADER\r\n";
    const auto add = [&](std::uint32_t type, const std::vector<std::uint32_t>& events) {
        const auto n = std::uint32_t(events.size() / 2);
        bytes += words({type | 1U << 16, 8, 4, 0, n, n, n}) + words(events);
    };
    const auto add_events = [&](std::uint32_t begin_ms) {
        std::vector<std::uint32_t> events;
        for (std::uint32_t i = 0; i < 400; ++i)
            events.insert(events.end(), {3U | i % 128 << 17, 1000 * (begin_ms + i)});
        add(1, events);
    };
    add_events(first_ms);
    constexpr std::uint32_t kTimestampReset = 1U | 1U << 1;
    add(0, {kTimestampReset, 0x7FFFFFFF});
    add_events(second_ms);
    return bytes;
}

TEST_F(RunPart, IsOneOfTheClockThatTheRecordingBeginsWith) {
    write_text(temp_ / "two.aedat", two_clocks(5000, 1000));
    const auto events_in = [&](const std::vector<std::string>& command) {
        const Result result = eventide(command);
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return Json::parse(eventide({"info", "o.aedat4", "--json"}).output)["events"].get<int>();
    };
    const auto run = [&](std::vector<std::string> part) {
        std::vector<std::string> all{"run",   "two.aedat",    "--noise-filter", "off",
                                     "--out", "null",         "--lamp-flicker", "off",
                                     "--fps", "10",           "--overwrite",    "--warmup",
                                     "0s",    "--events-out", "o.aedat4"};
        all.insert(all.end(), part.begin(), part.end());
        return events_in(all);
    };
    const auto convert = [&](std::vector<std::string> part) {
        std::vector<std::string> all{"convert", "two.aedat", "o.aedat4", "--overwrite"};
        all.insert(all.end(), part.begin(), part.end());
        return events_in(all);
    };
    EXPECT_EQ(run({"--from", "200ms"}), 200 + 400);
    EXPECT_EQ(convert({"--from", "200ms"}), 200 + 400);
    EXPECT_EQ(run({"--from", "200ms", "--to", "299ms"}), 100);
    EXPECT_EQ(convert({"--from", "200ms", "--to", "299ms"}), 100);
    EXPECT_EQ(convert({"--to", "500ms"}), 400 + 400) << "which the first did not reach";
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

TEST_F(RunPart, TheSummaryCountsTheEventsThatFiltersLeftInIt) {
    write_text(temp_ / "e.txt", "8 8\n0.100000 1 2 1\n0.150000 3 4 0\n0.200000 5 6 1\n");
    for (const auto& [filter, events] : {std::pair{"off", "2 events"}, {"auto", "1 event"}}) {
        const Result result =
            eventide({"run", "e.txt", "--to", "@150000", "--noise-filter", filter, "--lamp-flicker",
                      "off", "--window", "50ms", "--fps", "frame", "--out", "a/", "--overwrite"});
        EXPECT_NE(result.error.find(std::string{" from "} + events + " in "), std::string::npos)
            << result.error;
        int in_windows = 0;
        for (const long long n : column(temp_ / "a/timestamps.csv", 5)) in_windows += int(n);
        EXPECT_EQ(std::to_string(in_windows), std::string{events}.substr(0, 1));
    }
}

}  // namespace
}  // namespace eventide::test
