// Signals, readers that go away, and the end nobody can catch.
#include "tests/system/program_test.h"

#include <gmock/gmock.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <vector>

namespace eventide::test {
namespace {

constexpr std::size_t kPixels = 64 * 48;
constexpr const char* kEndless = "sim:demo?size=64x48";

class Signals : public ProgramTest {};

TEST_F(Signals, TheFirstSigintDrainsAndClosesEverything) {
    // Each frame in the pipe is to be one in the files: none is repeated.
    Process process =
        start({"run", kEndless, "--fps", "100", "--overload", "skip", "--out", "gray8:-", "--out",
               "video.mp4", "--out", "frames/", "--stats", "stats.jsonl"},
              {.output_to_pipe = true});
    ASSERT_EQ(process.read_output(5 * kPixels).size(), 5 * kPixels);
    process.signal(SIGINT);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    const auto times = column(temp_ / "frames/timestamps.csv", 2);
    EXPECT_GE(times.size(), 5U);
    EXPECT_EQ(packet_times(temp_ / "video.mp4").size(), times.size());
    EXPECT_NE(read_text(temp_ / "stats.jsonl").find("\"final\":true"), std::string::npos);
    const std::string record = read_text(temp_ / "frames/run.json");
    EXPECT_NE(record.find("\"finished\": true"), std::string::npos);
    EXPECT_NE(record.find("\"complete\": false"), std::string::npos) << "it was stopped";
    EXPECT_NE(result.error.find("frames from"), std::string::npos) << "the summary";
}

TEST_F(Signals, ASecondSignalQuitsAtOnce) {
    // Nobody reads the pipe, so the first signal cannot finish its work.
    Process process =
        start({"run", kEndless, "--fps", "1000", "--out", "grayf32:-"}, {.output_to_pipe = true});
    ASSERT_EQ(process.read_output(4 * kPixels).size(), 4 * kPixels);
    process.signal(SIGINT);
    process.signal(SIGTERM);
    // Reading now would let it end properly: only its end is waited for.
    while (process.running()) process.signal(SIGTERM);
    // Any thread may take a signal: which of the two is the second is not told.
    EXPECT_THAT(process.wait().exit_code, testing::AnyOf(128 + SIGINT, 128 + SIGTERM));
}

TEST_F(Signals, APipeThatSaysNothingIsLeftAtTheFirstSignal) {
    const std::string pipe = temp_ / "events";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"run", pipe, "--out", "frames/"},
          {"info", pipe},
          {"convert", pipe, "out.txt"}}) {
        Process process = start(command);
        const int writer = ::open(pipe.c_str(), O_WRONLY | O_CLOEXEC);  // returns when it reads
        process.signal(SIGTERM);
        const Result result = process.wait();
        ::close(writer);
        // A service that is stopped has not failed.
        EXPECT_EQ(result.exit_code, command[0] == "run" ? 0 : 1) << command[0];
        EXPECT_NE(result.error.find(pipe + ": stopped while waiting for the first bytes"),
                  std::string::npos)
            << result.error;
    }
    EXPECT_FALSE(std::filesystem::exists(temp_ / "frames"));
    EXPECT_FALSE(std::filesystem::exists(temp_ / "out.txt"));
}

TEST_F(Signals, APipeThatNobodyReadsIsLeftAtTheFirstSignal) {
    const std::string pipe = temp_ / "events.txt", video = temp_ / "video.mp4";
    for (const std::string& made : {pipe, video}) ASSERT_EQ(mkfifo(made.c_str(), 0600), 0);
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"run", recording(), "--out", "null", "--events-out", pipe},
          {"run", recording(), "--out", "null", "--record", pipe},
          {"run", recording(), "--out", "null", "--stats", pipe},
          {"run", recording(), "--out", "null", "--state-out", pipe},
          {"run", recording(), "--out", "gray8:" + pipe},
          {"run", recording(), "--out", video},
          {"convert", recording(), pipe},
          {"simulate", "--size", "64x48", "--out", pipe}}) {
        Process process = start(command);
        while (process.running() && !process.catches(SIGTERM)) continue;
        process.signal(SIGTERM);
        const Result result = process.wait();
        EXPECT_LE(result.exit_code, 1) << testing::PrintToString(command);
        EXPECT_NE(result.error.find(command.back().substr(command.back().find('/')) +
                                    ": nobody read it\n"),
                  std::string::npos)
            << testing::PrintToString(command) << result.error;
    }
}

TEST_F(Signals, APipeWhoseReaderStandsStillIsLeftAtTheFirstSignal) {
    const std::string pipe = temp_ / "frames";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    Process process =
        start({"run", kEndless, "--out", "grayf32:" + pipe, "--record", "all.aedat4"});
    const int reader = ::open(pipe.c_str(), O_RDONLY);
    // The program makes it smaller with its first frame.
    for (int waiting = 0;
         process.running() && (waiting == 0 || waiting < ::fcntl(reader, F_GETPIPE_SZ));)
        ::ioctl(reader, FIONREAD, &waiting);
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait().exit_code, 0);
    EXPECT_EQ(eventide({"info", "all.aedat4", "--strict"}).exit_code, 0) << "closed as it should";
    ::close(reader);
}

TEST_F(Signals, SomeMeasurementsAreNotTakenForAll) {
    std::vector<std::string> command{"bench", "--json", "all.json"};
    // More than it measures until the signal comes.
    for (int n = 0; n < 1000; ++n) command.insert(command.end(), {"--sizes", "64x48"});
    Process process = start(command);
    while (process.running() && !process.catches(SIGTERM)) continue;
    process.signal(SIGTERM);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.error.find("stopped before everything was measured"), std::string::npos)
        << result.error;
    EXPECT_FALSE(std::filesystem::exists(temp_ / "all.json"));
}

TEST_F(Signals, SomeHardCasesAreNotTakenForAll) {
    Process process =
        start({"stress", "--models", model(), "--soak", "10000", "--json", "all.json"});
    while (process.running() && !process.catches(SIGTERM)) continue;
    process.signal(SIGTERM);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.error.find("stopped before all cases had run"), std::string::npos)
        << result.error;
    EXPECT_FALSE(std::filesystem::exists(temp_ / "all.json"));
}

TEST_F(Signals, AClosedTerminalEndsLikeSigtermHoweverOftenItHangsUp) {
    Process process = start({"run", kEndless, "--fps", "100", "--out", "gray8:-", "--out",
                             "video.mp4", "--out", "frames/"},
                            {.output_to_pipe = true});
    ASSERT_EQ(process.read_output(5 * kPixels).size(), 5 * kPixels);
    for (int n = 0; n < 3; ++n) process.signal(SIGHUP);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(packet_times(temp_ / "video.mp4").size(),
              column(temp_ / "frames/timestamps.csv", 2).size());
    EXPECT_TRUE(std::filesystem::exists(temp_ / "frames/run.json"));
}

TEST_F(Signals, NohupIsRespected) {
    Process process{{"bash", "-c",
                     "trap '' HUP; exec " EVENTIDE_PROGRAM " run " + std::string{kEndless} +
                         " --model " + model() + " --fps 100 --out gray8:-"},
                    {.output_to_pipe = true}};
    ASSERT_EQ(process.read_output(5 * kPixels).size(), 5 * kPixels);
    process.signal(SIGHUP);
    EXPECT_EQ(process.read_output(20 * kPixels).size(), 20 * kPixels) << "it goes on";
    process.signal(SIGINT);
    EXPECT_EQ(process.wait().exit_code, 0);
}

TEST_F(Signals, AReaderThatGoesAwayIsAProperEnd) {
    Process process = start({"run", kEndless, "--out", "-"}, {.output_to_pipe = true});
    EXPECT_EQ(process.read_output(9), "YUV4MPEG2");
    process.read_output(2 * kPixels);
    process.close_output();
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result.error.find("error"), std::string::npos) << result.error;
}

void leave(const std::string& pipe) {
    const int reader = ::open(pipe.c_str(), O_RDONLY);
    char byte = 0;
    EXPECT_EQ(::read(reader, &byte, 1), 1);
    ::close(reader);
}

TEST_F(Signals, EveryPipeWhoseReaderGoesAwayEndsTheRunOrIsOneOutputLess) {
    const std::string record = temp_ / "all.aedat4", events = temp_ / "events.txt",
                      video = temp_ / "video.mp4";
    for (const std::string& pipe : {record, events, video})
        ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const auto& [option, pipe] : {std::pair{std::string{"--record"}, record},
                                       {std::string{"--events-out"}, events},
                                       {std::string{"--out"}, video}}) {
        Process alone = start({"run", kEndless, option, pipe, "--out", "null"});
        leave(pipe);
        const Result result = alone.wait();
        EXPECT_EQ(result.exit_code, 0) << result.error;
        EXPECT_NE(result.error.find(pipe + ": its reader went away\n"), std::string::npos)
            << result.error;

        Process with_others =
            start({"run", kEndless, option, pipe, "--out", "gray8:-", "--overload", "skip"},
                  {.output_to_pipe = true});
        leave(pipe);
        while (with_others.error_so_far().find("the run goes on") == std::string::npos)
            ASSERT_EQ(with_others.read_output(kPixels).size(), kPixels) << pipe;
        EXPECT_EQ(with_others.read_output(kPixels).size(), kPixels);
        with_others.close_output();
        EXPECT_EQ(with_others.wait().exit_code, 0) << "and ends with its last reader";
    }
}

TEST_F(Signals, SigmaApartFromItsVideoIsAnOutputOfItsOwn) {
    const std::string video = temp_ / "video.mp4", sigma = temp_ / "video.sigma.mp4";
    for (const std::string& pipe : {video, sigma}) ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    Process process = start({"run", kEndless, "--out", video, "--uncertainty", "separate"});
    const int reader = ::open(video.c_str(), O_RDONLY);
    leave(sigma);
    std::array<char, 4096> bytes{};
    while (process.error_so_far().find("the run goes on") == std::string::npos)
        ASSERT_GT(::read(reader, bytes.data(), bytes.size()), 0);
    ::close(reader);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_NE(result.error.find(sigma + ": its reader went away; the run goes on"),
              std::string::npos)
        << result.error;
    EXPECT_NE(result.error.find(video + ": its reader went away\n"), std::string::npos)
        << result.error;
}

TEST_F(Signals, CountersThatNobodyReadsAnyMoreAreToldAndEndNoRun) {
    const std::string stats = temp_ / "stats";
    ASSERT_EQ(mkfifo(stats.c_str(), 0600), 0);
    Process process =
        start({"run", kEndless, "--out", "gray8:-", "--stats", stats}, {.output_to_pipe = true});
    leave(stats);
    EXPECT_EQ(process.read_output(5 * kPixels).size(), 5 * kPixels);
    process.signal(SIGINT);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_NE(result.error.find("--stats " + stats + ": its reader went away\n"), std::string::npos)
        << result.error;
}

TEST_F(Signals, AConversionWhoseReaderGoesAwayDoesNotSayThatAllWasWritten) {
    Process process =
        start({"convert", recording(), "-", "--to-format", "text"}, {.output_to_pipe = true});
    process.read_output(100);
    process.close_output();
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_NE(result.error.find("standard output: its reader went away"), std::string::npos)
        << result.error;
    EXPECT_EQ(result.error.find("wrote"), std::string::npos) << result.error;
}

TEST_F(Signals, ASimulationWhoseReaderGoesAwayEnds) {
    const std::string pipe = temp_ / "made.aedat4";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    Process process = start({"simulate", "--seconds", "100000", "--size", "64x48", "--out", pipe});
    leave(pipe);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result.error, "eventide: info: " + pipe + ": its reader went away\n");
}

TEST_F(Signals, AKilledRunLeavesAVideoThatPlaysAndFilesThatAreWhole) {
    Process process = start({"run", kEndless, "--fps", "200", "--overload", "skip", "--out",
                             "video.mp4", "--out", "frames/", "--out", "gray8:-"},
                            {.output_to_pipe = true});
    ASSERT_EQ(process.read_output(150 * kPixels).size(), 150 * kPixels);
    process.signal(SIGKILL);
    EXPECT_EQ(process.wait().exit_code, 128 + SIGKILL);
    EXPECT_GE(packet_times(temp_ / "video.mp4").size(), 60U);
    EXPECT_GE(column(temp_ / "frames/timestamps.csv", 2).size(), 149U);
}

TEST_F(Signals, ALiveRunEndsByItself) {
    const Result result = eventide({"run", kEndless, "--duration", "100ms", "--out", "null"});
    EXPECT_EQ(result.exit_code, 0) << result.error;
}

}  // namespace
}  // namespace eventide::test
