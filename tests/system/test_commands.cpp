// info, run, simulate, evaluate, devices and doctor, as a user runs them.
#include "tests/system/commands_test.h"

#include <filesystem>
#include <map>
#include <string>
#include <utility>

namespace eventide::test {
namespace {

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

TEST_F(Commands, InfoKnowsAModelAndAStateByTheirContent) {
    std::filesystem::copy_file(model(), temp_ / "model.bin");
    const Result words = eventide({"info", "model.bin"});
    EXPECT_EQ(words.exit_code, 0) << words.error;
    EXPECT_EQ(words.output, eventide({"info", model()}).output);
    ASSERT_EQ(
        eventide({"run", recording(), "--duration", "20ms", "--out", "null", "--state-out", "a.st"})
            .exit_code,
        0);
    const Result state = eventide({"info", "a.st"});
    EXPECT_EQ(state.exit_code, 3);
    EXPECT_NE(state.error.find("a.st: expected a recording or a model, found a saved state"),
              std::string::npos)
        << state.error;
}

TEST_F(Commands, InfoDescribesAModelByTheNameThatRunsGiveIt) {
    const Result small = eventide({"info", "small"});
    EXPECT_EQ(small.exit_code, 0) << small.error;
    EXPECT_NE(small.output.find("weights"), std::string::npos);
    write_text(temp_ / "small", "64 48\n0.1 1 2 1\n0.2 1 2 0\n");
    EXPECT_EQ(info("small")["events"], 2) << "a file of that name comes first";
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

TEST_F(Commands, AStreamThatDoesNotSayTheSensorsSizeIsAskedForWhatItsFormatCanSay) {
    const std::string state = "found none in the stream; state it with --input-size";
    const std::string begin = "found none in the stream; begin the text with a line";
    const std::string evt2{"% evt 2.0\n\0\0\0\x80\0\0\0\x10", 18};
    for (const auto& [stream, words] :
         {std::pair{evt2, state}, {std::string{"1000 1 2 1\n2000 1 2 1\n"}, begin}}) {
        const Result result = eventide({"info", "-"}, {.input = stream});
        EXPECT_EQ(result.exit_code, 3);
        EXPECT_NE(result.error.find(words), std::string::npos) << result.error;
    }
}

TEST_F(Commands, EvaluateOfNothingScoredIsNoSuccess) {
    // EVREAL scores this sequence from its first second on.
    ASSERT_EQ(
        eventide({"simulate", "--seconds", "0.1", "--size", "64x48", "--out", "all/slider_depth/"})
            .exit_code,
        0);
    const Result result = eventide({"evaluate", "all", "--protocol", "evreal"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_NE(result.output.find("none of its images lies in the cut"), std::string::npos)
        << result.output;
    EXPECT_NE(result.error.find("all: expected images in the parts that EVREAL scores, found none"),
              std::string::npos)
        << result.error;
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
