// info, convert, simulate, evaluate, bench and devices, as a user runs them.
#include "tests/system/program_test.h"

#include <gmock/gmock.h>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

class Commands : public ProgramTest {
protected:
    Json info(const std::string& file) const {
        const Result result = eventide({"info", file, "--json"});
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return Json::parse(result.output);
    }
    void expect_same_events(const Json& a, const Json& b) const {
        for (const char* key : {"events", "on", "first_us", "last_us", "width", "height"})
            EXPECT_EQ(a[key], b[key]) << key;
    }
};

TEST_F(Commands, InfoSaysTheSameInJsonAndInWords) {
    const Json json = info(recording());
    EXPECT_EQ(json["format"], "aedat4");
    EXPECT_EQ(json["frames"], 11);
    const Result words = eventide({"info", recording()});
    EXPECT_NE(words.output.find(std::to_string(json["events"].get<int>())), std::string::npos);
    EXPECT_EQ(words.error, "");
}

TEST_F(Commands, InfoDescribesAModel) {
    const Result words = eventide({"info", model()});
    EXPECT_EQ(words.exit_code, 0) << words.error;
    EXPECT_NE(words.output.find("random weights, for tests"), std::string::npos);
    EXPECT_EQ(Json::parse(eventide({"info", model(), "--json"}).output)["bins"], "2");
}

TEST_F(Commands, ConvertLosesNoEventAndSaysWhatHasNoPlace) {
    const Json original = info(recording());
    std::string from = recording();
    for (const char* to : {"a.txt", "b.raw", "c.aedat4"}) {
        const Result result = eventide({"convert", from, to});
        ASSERT_EQ(result.exit_code, 0) << to << result.error;
        expect_same_events(info(temp_ / to), original);
        from = to;
    }
    const Result result = eventide({"convert", recording(), "d.raw", "--strict"});
    EXPECT_EQ(result.exit_code, 5);
    EXPECT_NE(result.error.find("11 images"), std::string::npos) << result.error;
    EXPECT_EQ(eventide({"convert", recording(), "d.raw"}).exit_code, 2) << "it exists already";
}

TEST_F(Commands, RunSaysWhatItsRecordingHasNoPlaceFor) {
    const auto run = [&](const char* option, const char* file) {
        return eventide({"run", recording(), "--out", "null", option, file, "--strict"});
    };
    const Result result = run("--record", "a.raw");
    EXPECT_EQ(result.exit_code, 5);
    EXPECT_NE(result.error.find("a.raw: left out what its format cannot hold: 11 images"),
              std::string::npos)
        << result.error;
    EXPECT_EQ(run("--record", "a.aedat4").exit_code, 0);
    EXPECT_EQ(run("--events-out", "b.raw").exit_code, 0) << "events are all that was asked for";
}

TEST_F(Commands, ConvertWritesAFolderOfTheEventCameraDatasetAndReadsItBack) {
    const Json original = info(recording());
    const Result result = eventide({"convert", recording(), "ecd/"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    expect_same_events(info(temp_ / "ecd"), original);
    EXPECT_EQ(info(temp_ / "ecd")["frames"], original["frames"]);
    EXPECT_EQ(probe(temp_ / "ecd/images/frame_00000000.png", "width,height"), "64,48\n");
    ASSERT_EQ(eventide({"convert", "ecd/", "back.aedat4"}).exit_code, 0);
    expect_same_events(info(temp_ / "back.aedat4"), original);
    EXPECT_EQ(info(temp_ / "back.aedat4")["frames"], original["frames"]);

    EXPECT_EQ(eventide({"convert", recording(), "ecd/"}).exit_code, 2) << "it holds something";
    EXPECT_EQ(eventide({"convert", recording(), "ecd/", "--overwrite"}).exit_code, 0);
    EXPECT_EQ(eventide({"convert", "ecd/", "ecd/", "--overwrite"}).exit_code, 2) << "its own input";
    EXPECT_EQ(eventide({"convert", recording(), "b/", "--to-format", "text"}).exit_code, 2);
}

TEST_F(Commands, ConvertSaysWhatItWritesWhereTheTargetIsNoneOfThat) {
    const Result csv = eventide({"convert", recording(), "a.csv"});
    EXPECT_EQ(csv.exit_code, 2);
    EXPECT_NE(csv.error.find(".aedat4, "), std::string::npos) << csv.error;
    EXPECT_NE(csv.error.find(".txt"), std::string::npos) << csv.error;
    for (const char* name : {"evt2", "csv"}) {  // one is read only, the other is none at all
        const Result result = eventide({"convert", recording(), "a.raw", "--to-format", name});
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_NE(result.error.find("--to-format: expected one of aedat4"), std::string::npos)
            << result.error;
        EXPECT_NE(result.error.find("hdf5"), std::string::npos) << result.error;
    }
}

TEST_F(Commands, ConvertWritesTextToStandardOutput) {
    const Result result =
        eventide({"convert", recording(), "-", "--to-format", "text", "--to", "10ms"});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result.output.substr(0, 6), "64 48\n");
}

TEST_F(Commands, ConvertTakesAPart) {
    ASSERT_EQ(eventide({"convert", recording(), "a.aedat4", "--from", "100ms", "--to", "200ms"})
                  .exit_code,
              0);
    const Json part = info(temp_ / "a.aedat4"), whole = info(recording());
    EXPECT_GE(part["first_us"].get<long long>(), whole["first_us"].get<long long>() + 100'000);
    EXPECT_LE(part["last_us"].get<long long>(), whole["first_us"].get<long long>() + 200'000);
    EXPECT_GT(part["events"].get<int>(), 0);
}

TEST_F(Commands, ConvertCountsTimesOfFiltersFromTheFirstEventOfTheRecording) {
    ASSERT_EQ(eventide({"convert", recording(), "a.aedat4", "--from", "100ms", "--filter",
                        "time:150ms..200ms"})
                  .exit_code,
              0);
    ASSERT_EQ(eventide({"run", recording(), "--from", "100ms", "--warmup", "0s", "--filter",
                        "time:150ms..200ms", "--out", "null", "--events-out", "b.aedat4"})
                  .exit_code,
              0);
    const long long first = info(recording())["first_us"].get<long long>();
    for (const char* file : {"a.aedat4", "b.aedat4"}) {
        const Json part = info(temp_ / file);
        EXPECT_GE(part["first_us"].get<long long>(), first + 150'000) << file;
        EXPECT_LT(part["first_us"].get<long long>(), first + 155'000) << file;
        EXPECT_LE(part["last_us"].get<long long>(), first + 200'000) << file;
    }
}

TEST_F(Commands, ConvertSendsDatagrams) {
    const int reader = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof here;
    ASSERT_EQ(bind(reader, reinterpret_cast<sockaddr*>(&here), length), 0);
    getsockname(reader, reinterpret_cast<sockaddr*>(&here), &length);
    const std::string to = "udp://127.0.0.1:" + std::to_string(ntohs(here.sin_port));
    const Result sent = eventide({"convert", recording(), to, "--to", "5ms"});
    EXPECT_EQ(sent.exit_code, 0) << sent.error;
    const auto received = [reader] {
        std::size_t bytes = 0;
        char datagram[2048];
        for (ssize_t n; (n = recv(reader, datagram, sizeof datagram, MSG_DONTWAIT)) > 0;)
            bytes += std::size_t(n);
        return bytes;
    };
    const std::size_t bytes = received();
    const Result of_run =
        eventide({"run", recording(), "--to", "5ms", "--out", "null", "--events-out", to});
    EXPECT_EQ(of_run.exit_code, 0) << of_run.error;
    EXPECT_GT(received(), 0U);
    close(reader);
    ASSERT_EQ(eventide({"convert", recording(), "a.aedat4", "--to", "5ms"}).exit_code, 0);
    EXPECT_EQ(bytes, 13 * info(temp_ / "a.aedat4")["events"].get<std::size_t>());
    // Nobody listens any more.
    const Result lost = eventide({"convert", recording(), to, "--strict"});
    EXPECT_EQ(lost.exit_code, 5);
    EXPECT_NE(lost.error.find("that nobody received"), std::string::npos) << lost.error;
    const Result format = eventide({"convert", recording(), to, "--to-format", "text"});
    EXPECT_EQ(format.exit_code, 2);
    EXPECT_NE(format.error.find("?format=t64"), std::string::npos) << format.error;
}

TEST_F(Commands, SimulateIsTheSameForTheSameSeed) {
    const auto simulate = [&](const std::string& seed, const std::string& file) {
        EXPECT_EQ(eventide({"simulate", "--seconds", "0.1", "--size", "32x24", "--seed", seed,
                            "--out", file})
                      .exit_code,
                  0);
        return read_text(temp_ / file);
    };
    EXPECT_EQ(simulate("3", "a.aedat4"), simulate("3", "b.aedat4"));
    EXPECT_NE(simulate("4", "c.aedat4"), read_text(temp_ / "a.aedat4"));
    const Result list = eventide({"simulate", "--list"});
    EXPECT_NE(list.output.find("demo"), std::string::npos);
}

TEST_F(Commands, SimulateWritesAFolderWithImagesAndTruthThatInfoAndRunRead) {
    const Result result =
        eventide({"simulate", "--seconds", "0.2", "--size", "32x24", "--out", "ecd/", "--truth",
                  "truth/", "--truth-scale", "2", "--truths-per-second", "50"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(info(temp_ / "ecd")["frames"], 6);
    EXPECT_EQ(column(temp_ / "truth/timestamps.csv", 2).size(), 11U);
    EXPECT_EQ(probe(temp_ / "truth/frames/frame_0000000000.png", "width,height"), "63,47\n");
    EXPECT_EQ(eventide({"run", "ecd", "--window", "aps", "--out", "a/"}).exit_code, 0);
}

TEST_F(Commands, EvaluateMeasuresARecordingAndFolders) {
    const Result result = eventide({"evaluate", recording(), "--json", "scores.json"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_NE(result.output.find("recording"), std::string::npos);
    const Json scores = Json::parse(read_text(temp_ / "scores.json"));
    EXPECT_GT(scores["frames"].get<int>(), 0);
    EXPECT_GT(scores["raw"]["mse"].get<double>(), 0);
    const Result most = eventide({"evaluate", recording(), "--skip", "100"});
    EXPECT_NE((most.output + most.error).find("of 11 images the first 10 are not scored"),
              std::string::npos)
        << most.output << most.error;

    ASSERT_EQ(
        eventide({"simulate", "--seconds", "0.2", "--size", "32x24", "--out", "a/"}).exit_code, 0);
    const Result same =
        eventide({"evaluate", "a/images", "a/images", "--protocol", "folders", "--json", "-"});
    ASSERT_EQ(same.exit_code, 0) << same.error;
    EXPECT_EQ(Json::parse(same.output)["raw"]["mse"], 0.0);
}

TEST_F(Commands, ImagesOfTheCameraCorrectWhatTheModelMissed) {
    const auto mse_with = [&](const std::string& given) {
        const Result result =
            eventide({"evaluate", recording(), "--skip", "1", "--frames", given, "--json", "-"});
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return Json::parse(result.output)["raw"]["mse"].get<double>();
    };
    EXPECT_LT(mse_with("2"), .5 * mse_with("0"));
    EXPECT_EQ(eventide({"evaluate", recording(), "--frames", "1"}).exit_code, 2) << "none is left";

    for (const std::string frames : {"auto", "use", "ignore"}) {
        const Result result = eventide({"run", recording(), "--frames", frames, "--out", "null"});
        ASSERT_EQ(result.exit_code, 0) << result.error;
        EXPECT_EQ(result.error.find("of the camera's images") != std::string::npos,
                  frames != "ignore")
            << result.error;
    }
    ASSERT_EQ(eventide({"convert", recording(), "events.txt"}).exit_code, 0);
    const Result none = eventide(
        {"run", "events.txt", "--input-size", "64x48", "--frames", "use", "--out", "null"});
    EXPECT_EQ(none.exit_code, 0) << none.error;
    EXPECT_NE(none.error.find("--frames use: no image of the camera"), std::string::npos)
        << none.error;
}

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

TEST_F(Commands, DevicesListsWhatThereIs) {
    const Result result = eventide({"devices", "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_TRUE(Json::parse(result.output).is_array());
}

TEST_F(Commands, DoctorSaysWhatWorksAndWhatToDo) {
    const Json findings = Json::parse(eventide({"doctor", "--json"}).output);
    std::map<std::string, Json> by_subject;
    for (const Json& finding : findings) by_subject[finding["subject"]] = finding;
    for (const char* subject : {"processor", "network", "video", "window", "page"})
        EXPECT_EQ(by_subject.count(subject), 1U) << subject;
    EXPECT_EQ(by_subject["video"]["state"], "ok");
    EXPECT_EQ(by_subject["window"]["state"], "absent") << "the tests' environment has no display";
    const Result words = eventide({"doctor"});
    EXPECT_NE(words.output.find("ok      video: libx264"), std::string::npos) << words.output;
}

TEST_F(Commands, RealRecordingsGoThroughTheWholeLine) {
    const std::string data = EVENTIDE_SOURCE_DIR "/../shared/data/formats";
    if (!std::filesystem::exists(data)) GTEST_SKIP() << "the real recordings are not here";
    struct Known {
        const char* file;
        int events, on;
    };
    for (const Known& known :
         {Known{"davis346_desk.aedat4", 6676, 3563}, Known{"evt3_1280x720_5000.raw", 5000, -1},
          Known{"ncars_4407_td.dat", 4407, 1671}}) {
        const Json json = info(data + "/" + known.file);
        EXPECT_EQ(json["events"], known.events) << known.file;
        if (known.on >= 0) {
            EXPECT_EQ(json["on"], known.on) << known.file;
        }
    }
    const Result result = eventide({"run", data + "/davis346_desk.aedat4", "--fps", "25", "--size",
                                    "1.5x", "--lookahead", "1", "--out", "a/"});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_GE(column(temp_ / "a/timestamps.csv", 2).front(), 1'589'163'147'368'867);
}

}  // namespace
}  // namespace eventide::test
