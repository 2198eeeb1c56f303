// Exit code 2: a command line, or a setting, that makes no sense is refused with what was meant.
#include "tests/system/program_test.h"

#include <filesystem>
#include <string>

namespace eventide::test {
namespace {

class WrongUsage : public ProgramTest {};

TEST_F(WrongUsage, IsRefused) {
    expect(2, {"fly"}, "fly");
    expect(2, {"rnu"}, "did you mean run?");
    expect(2, {"help", "rnu"}, "did you mean run?");
    expect(2, {"run", recording(), "--frm", "5ms"},
           "did you mean --from?; see eventide run --help");
    expect(2, {"run", recording(), "--strict", "--no-strict", "--out", "null"}, "--no-strict");
    expect(2, {"info", recording(), "another"}, "another");
    write_text(temp_ / "-x.txt", "64 48\n");
    expect(2, {"info", "-x.txt"}, "'-x.txt'; did you mean the file ./-x.txt?");
    expect(2, {"run"}, "SOURCE");
    expect(2, {"run", recording()}, "--out");
    expect(2, {"run", recording(), "--fsp", "3", "--out", "null"}, "--fsp");
    expect(2, {"run", recording(), "--fps", "-3", "--out", "null"}, "--fps");
    expect(2, {"run", recording(), "--lookahead", "3", "--out", "null"}, "--lookahead");
    expect(2, {"run", recording(), "--window", "soon", "--out", "null"}, "--window");
    expect(2, {"run", recording(), "--size", "big", "--out", "null"}, "--size");
    for (const char* size : {"2", "0.001x"})
        expect(2, {"run", recording(), "--size", size, "--out", "null"},
               "expected a factor from 0.01x to 64x, or pixels");
    expect(2, {"run", recording(), "--slow", "1e9", "--out", "null"}, "to 100000, found");
    expect(2, {"run", recording(), "--out"}, "--out: expected SINK, found none");
    expect(2, {"run", recording(), "--fps", "--out", "null"},
           "--fps: expected RATE, found the option --out");
    expect(2, {"run", recording(), "--out", "null", "--stats", "--quiet"},
           "--stats: expected FILE, found the option --quiet");
    expect(2, {"run", recording(), "--out=~/frames/"}, "--out ~/frames/: ");
    expect(2, {"convert", recording(), "~/a.txt"}, "~/a.txt: ");
    expect(2, {"evaluate", recording(), "--figure", "sigma", "--plots", "~/plots"}, "~/plots: ");
    expect(2, {"run", recording(), "--roi", "60,0,30x10", "--out", "null"}, "");
    for (const char* option : {"--config", "--hot-pixels"})
        expect(2, {"run", recording(), option, "/dev/zero", "--out", "null"},
               "/dev/zero: expected at most ");
    expect(2, {"run", recording(), "--out", "frame.bmp"}, "frame.bmp");
    expect(2, {"run", recording(), "--out", "-", "--out", "gray8:-"}, "standard output");
    expect(2, {"run", recording(), "--out", "a.mp4", "--uncertainty", "alpha"},
           "separate, side or overlay, found alpha");
    expect(2, {"run", recording(), "--out", "a.gif", "--uncertainty", "alpha"},
           "separate or side, found alpha");
    expect(2, {"run", recording(), "--out", "gray8:a", "--events"},
           "--events: expected the window, a video or a folder to show them in, found none");
    expect(2, {"run", recording(), "--out", "a.mp4", "--video-preset", "quick"}, "quick");
    expect(2, {"run", recording(), "--out", "null", "--from", "2s", "--to", "1s"}, "--to");
    for (const char* views : {"0", "3", "5", "2.0"})
        expect(2, {"run", recording(), "--out", "null", "--self-ensemble", views},
               std::string{"flag --self-ensemble: expected 1, 2 or 4, found '"} + views + "'");
    expect(2, {"run", recording(), "--out", "window"}, "display");
    expect(2, {"bench", "--peers", "peers.csv"}, "expected --report");
    expect(2, {"bench", "--report", "r/", "--json", "a"}, "--json a: expected no --report");
    expect(2, {"bench", "--report", "r/", "--plots", "p/"}, "--plots p/: expected no --report");
    expect(2, {"bench", "--report", "r/", "--scale", "2"}, "expected --scale 1, found 2");
    expect(2, {"bench", "--lpips", "l.npz"}, "--lpips l.npz: expected --report FOLDER, found none");
    for (const std::string only : {"--stages", "--activity"}) {
        expect(2, {"bench", only, "--plots", "p/"}, "--plots p/: expected no " + only);
        expect(2, {"bench", only, "--report", "r/"}, only + ": expected no --report");
    }
    expect(2, {"bench", "--sizes", "64x48", "--sizes", "64"}, "--sizes: expected a size such as");
    expect(2, {"bench", "--precisions", "f32", "--precisions", "f16"},
           "--precisions: expected auto, f32 or bf16, found 'f16'");
    expect(2, {"stress", "--plots", "p/"}, "--plots p/: expected --soak HOURS, found none");
    expect(2, {"convert", recording(), "a.xyz"}, "a.xyz");
    expect(2, {"simulate", "--scene", "nowhere", "--out", "a.aedat4"}, "nowhere");
    expect(2, {"evaluate", recording(), "--protocol", "folders"}, "two folders");
    expect(2, {"evaluate", recording(), "--frames", "2", "--calibrated", "a.safetensors"},
           "--calibrated a.safetensors: ");
    expect(2, {"evaluate", recording(), "--calibrated", ""}, "--calibrated: expected FILE");
    // Before the figure is simulated, which takes minutes.
    expect(2, {"evaluate", "--figure", "spatial", "--figure", "events"}, "one or more recordings");
    expect(2, {"evaluate", recording(), "--json", "-", "--csv", "-"}, "--csv -: --json - has");
    for (const char* other : {"spatial", "events"})
        expect(2, {"evaluate", recording(), "--figure", other, "--figure", "nothing"},
               "no figure is called 'nothing'");
    expect(2, {"evaluate", recording(), "--figure", "spatial"},
           "expected no input, found " + recording() + "; --figure spatial");
    expect(2, {"evaluate", recording(), "--figure", "sgima"},
           "no figure is called 'sgima'; there are: events, ");
    expect(2, {"evaluate", recording(), "--plots", "p/"}, "--plots p/: expected --figure NAME");
    expect(2, {"evaluate", "a", "b", "--protocol", "folders", "--figure", "events"},
           "--figure events: expected an evaluation of a model");
    expect(2, {"evaluate", recording(), "--figure", "patch-size"},
           "--figure patch-size: expected --lpips FILE, found none");
    expect(2, {"evaluate", "--figure", "sigma", "--figure", "spatial"},
           "expected one or more recordings");
    expect(2, {"run", "sim:demo?size=1x1", "--out", "null"}, "2 to 8192 px, found 1\n");
    expect(2, {"bench", "--sizes", "32x24", "--sizes", "32"}, "--sizes: expected a size such as");
    expect(2, {"bench", "--precisions", "f16"}, "--precisions: expected auto, f32 or bf16");
    expect(2, {"bench", "--scene", "nowhere"}, "no simulated scene is called 'nowhere'");
    expect(2, {"evaluate", recording(), "--from", "200ms", "--to", "100ms"}, "--to: expected");
    expect(2, {"evaluate", recording(), "--from", "10s"}, "expected an image to score between");
    expect(2, {"run", recording(), "--out", "null", "--events-out", "evt2:a.raw"},
           "expected aedat4, aedat3, evt3, hdf5, text before the colon, found evt2");
    for (const std::string output : {"--json", "--csv", "--frame-csv", "--calibrated"})
        expect(2, {"evaluate", "--figure", "silence", output, "a"},
               output + " a: expected an evaluation, found --figure silence");
}

TEST_F(WrongUsage, AFlagThatWouldChangeNothing) {
    const auto run = [&](std::vector<std::string> flags, const std::string& words) {
        flags.insert(flags.begin(), {"run", recording(), "--out", "x.gif"});
        expect(2, flags, words);
    };
    run({"--warmup", "1s"}, "--warmup: expected --from, before which it lies, found none");
    run({"--sheet-rows", "4"}, "--sheet-rows: expected contact-sheet:x.png as --out, found none");
    run({"--video-crf", "20"}, "--video-crf: expected x.mp4 or x.mkv as --out, found none");
    run({"--video-preset", "fast"}, "--video-preset: expected x.mp4 or x.mkv as --out");
    run({"--overload", "skip"}, "--overload: expected a raw stream or Y4M as --out, found none");
    run({"--http-token", "a"}, "--http-token: expected http:ADDRESS:PORT as --out, found none");
    run({"--http-name", "a"}, "--http-name: expected http:ADDRESS:PORT as --out, found none");
    run({"--engine", "plain", "--precision", "bf16"},
        "--precision: expected f32 with --engine plain, found bf16");
    run({"--engine", "plain", "--kernels", "onednn"},
        "--kernels: expected own with --engine plain, found onednn");
    for (const auto& [flag, value] : {std::pair{"--input-columns", "txyp"},
                                      {"--input-time-unit", "us"},
                                      {"--reorder", "1ms"}}) {
        for (const auto& command : {std::vector<std::string>{"run", recording(), "--out", "null"},
                                    {"info", recording()},
                                    {"convert", recording(), "a.txt"},
                                    {"evaluate", recording()}}) {
            std::vector<std::string> words = command;
            words.insert(words.end(), {flag, value});
            expect(2, words, std::string{flag} + ": expected a recording in the format text");
        }
        expect(2, {"run", "sim:demo", "--out", "null", flag, value},
               std::string{flag} + ": expected a recording as SOURCE, found sim:demo");
    }
    expect(2, {"info", recording(), "--input-dvs128-one-is-on"},
           "--input-dvs128-one-is-on: expected a recording in the format aedat1 or aedat2, found "
           "aedat4");
    expect(2, {"run", "davis:", "--out", "null", "--input-dvs128-one-is-on"},
           "--input-dvs128-one-is-on: expected a recording as SOURCE, found davis:");
    expect(2, {"simulate", "--out", "a.aedat4", "--truth-scale", "2"},
           "--truth-scale: expected --truth FOLDER, found none");
    expect(2, {"bench", "--still-time", "1"},
           "--still-time: expected --activity or --report FOLDER, found none");
    expect(2, {"stress", "--soak", "1", "--cases", "on*"},
           "--cases: expected no --soak, which runs no cases, found 1 h");
    // Of other runs, too.
    write_text(temp_ / "my.toml",
               "[run]\nwarmup = '1s'\nsheet_rows = 3\nvideo_crf = 20\nhttp_token = 'a'\n"
               "[evaluate]\nsequences = 3\ncalibration = 'cautious'\n");
    for (const auto& command : {std::vector<std::string>{"run", recording(), "--out", "null"},
                                {"evaluate", recording()}}) {
        const Result result =
            eventide(command, {.environment = {{"EVENTIDE_CONFIG", temp_ / "my.toml"}}});
        EXPECT_EQ(result.exit_code, 0) << result.error;
    }
}

TEST_F(WrongUsage, AFlagOfAnotherProtocol) {
    expect(2, {"evaluate", "--protocol", "simulated", "--window", "50ms"},
           "--window: expected --protocol recordings, found simulated");
    expect(2, {"evaluate", "--protocol", "simulated", "--input-size", "64x48"},
           "--input-size: expected --protocol recordings, found simulated");
    expect(2, {"evaluate", "--protocol", "simulated", "--lamp-flicker", "off"},
           "--lamp-flicker: expected --protocol recordings or evreal, found simulated");
    expect(2, {"evaluate", recording(), "--sequences", "3"},
           "--sequences: expected --protocol simulated, found recordings");
    expect(2, {"evaluate", "a", "--protocol", "evreal", "--skip", "3"},
           "--skip: expected --protocol recordings, found evreal");
    expect(2, {"evaluate", "a", "b", "--protocol", "folders", "--lookahead", "2"},
           "--lookahead: expected --protocol recordings, evreal or simulated, found folders");
    expect(2, {"evaluate", "--figure", "silence", "--window", "50ms"},
           "--window: expected --protocol recordings, found --figure silence");
    expect(2, {"evaluate", recording(), "--calibration", "cautious"},
           "--calibration: expected --calibrated FILE, found none");
}

TEST_F(WrongUsage, AListThatWasLeftEmpty) {
    write_text(temp_ / "empty.toml",
               "[bench]\nsizes = []\nmodels = []\nprecisions = []\n[stress]\nmodels = []\n");
    for (const char* command : {"bench", "stress"})
        expect(2, {command, "--config", "empty.toml"}, ": expected one or more, found an empty");
    expect(2, {"bench", "--config", "empty.toml", "--sizes", "64x48", "--precisions", "f32"},
           "--models: expected one or more");
}

TEST_F(WrongUsage, APartOfARecordingThatIsNotThere) {
    expect(2, {"run", recording(), "--from", "100s", "--out", "a/"}, "--from 100s: expected a");
    expect(2, {"run", recording(), "--from", "@99999999999", "--out", "a/"}, "--from @99999999999");
    expect(2, {"run", recording(), "--to", "@-5", "--out", "a/"}, "--to: expected a time after");
    // Also where both ends are given, and in another format.
    expect(2, {"run", recording(), "--from", "@-9", "--to", "@-5", "--out", "a/"},
           "--to: expected");
    expect(2, {"convert", recording(), "a.raw", "--from", "100s"}, "--from 100s: expected a");
    expect(2, {"convert", recording(), "a.raw", "--to", "@-5"}, "--to: expected a time after");
    expect(2, {"convert", recording(), "a/", "--from", "9ms", "--to", "5ms"},
           "lies before --from, by 4ms");
    expect(2, {"convert", recording(), "a.raw", "--filter", "time:20ms..10ms"}, "time:");
    EXPECT_FALSE(std::filesystem::exists(temp_ / "a.raw"));
    std::string text = "16 16\n";
    for (int i = 0; i < 100; ++i) text += "0." + std::to_string(100'000 + i) + " 1 2 1\n";
    write_text(temp_ / "no_images.txt", text);
    expect(2, {"run", "no_images.txt", "--window", "aps", "--out", "a/"}, "reference images");
    expect(2, {"run", "no_images.txt", "--camera", "a.toml", "--out", "a/"}, "a camera as SOURCE");
    EXPECT_FALSE(std::filesystem::exists(temp_ / "a")) << "nothing is left behind";
    const std::string past = eventide({"run", recording(), "--from", "9s", "--out", "a/"}).error;
    EXPECT_NE(past.find("until the last event, 0.39"), std::string::npos) << past;
    const Result aps = eventide({"run", recording(), "--window", "aps", "--out", "null"});
    EXPECT_EQ(aps.exit_code, 0) << aps.error;
}

TEST_F(WrongUsage, AFileWithoutAName) {
    for (const char* option : {"--state-out", "--state-in", "--states-out", "--record",
                               "--events-out", "--stats", "--undistort", "--camera"})
        expect(2, {"run", recording(), "--out", "null", option, ""},
               std::string{option} + ": expected ");
    expect(2, {"simulate", "--out", ""}, "--out: expected FILE|FOLDER/, found ''");
    expect(2, {"--config", "", "info", recording()}, "--config: expected FILE, found ''");
    expect(2, {"evaluate", recording(), "--calibrated", ""},
           "--calibrated: expected FILE, found ''");
}

TEST_F(WrongUsage, AFullFolderWithoutOverwrite) {
    std::filesystem::create_directory(temp_ / "a");
    write_text(temp_ / "a/mine.txt", "x");
    expect(2, {"run", recording(), "--out", "a/"}, "--overwrite");
    write_text(temp_ / "a.mp4", "x");
    expect(2, {"run", recording(), "--out", "a.mp4"}, "--overwrite");
    expect(2, {"run", recording(), "--out", "a.mp4/"}, "expected a folder, found a file");
    EXPECT_EQ(eventide({"run", recording(), "--out", "a/", "--overwrite"}).exit_code, 0);
    EXPECT_EQ(read_text(temp_ / "a/mine.txt"), "x");
}

TEST_F(WrongUsage, IsAnsweredWithWhatWasMeantInTheFieldsWords) {
    expect(2, {"run", "metavision:", "--out", "null"}, "unknown source; expected a file");
    expect(2, {"run", "daviss:", "--out", "null"}, "did you mean davis:?");
    expect(3, {"run", "davis", "--out", "null"}, "'davis': no such file; did you mean davis:?");
    expect(3, {"run", "sim", "--out", "null"}, "did you mean sim:?");
    for (const char* command : {"info", "evaluate"})
        expect(2, {command, "davis:"}, "expected a recording, found the name of a camera");
    expect(2, {"convert", "sim:demo", "a.txt"}, "found the name of a simulation");
    expect(2, {"run", "sim:demo", "--input-stream", "1", "--out", "null"},
           "--input-stream 1: expected a recording as SOURCE, found sim:demo");
    expect(2, {"run", recording(), "--input-stream", "/events", "--out", "null"},
           "expected an event stream /events, found 0 (");
    expect(2, {"run", recording(), "--reconnect", "--out", "null"},
           "--reconnect: expected a camera as SOURCE, found ");
    expect(2, {"run", "davis", "--reconnect", "--out", "null"}, "did you mean davis:?");
    expect(2, {"run", "sim:demo", "--reconnect", "--out", "null"}, "found sim:demo\n");
    expect(2, {"run", "sim:demo", "--input-size", "64x48", "--out", "null"},
           "--input-size 64x48: expected a recording as SOURCE, found sim:demo");
    expect(2, {"run", "davis:", "--input-format", "evt3", "--out", "null"},
           "--input-format evt3: expected a recording as SOURCE, found davis:");
    expect(2, {"run", recording(), "--out", "gray8:"}, "--out gray8: needs a path");
    expect(2, {recording()},
           "there is no command '" + recording() + "'; did you mean eventide run " + recording() +
               " --out video.mp4?");
    expect(2, {"run", recording(), "video.mp4"},
           "unexpected argument 'video.mp4'; did you mean --out?");
    expect(2, {"run", "--out", "null", "--", recording(), "--fps", "9"},
           "unexpected argument '--fps' '9'");
    expect(2, {"run", recording(), "--roi", "9999,0,5x5", "--out", "null"},
           "region (roi) exceeds the 64x48 frame");
    write_text(temp_ / "empty.raw", "");
    expect(3, {"info", "empty.raw"}, "the file is empty");
    write_text(temp_ / "letters.raw", "letters and nothing else, for a while, which is no format");
    expect(3, {"info", "letters.raw"}, "unrecognised format");
    expect(3, {"run", recording(), "--model", "letters.raw", "--out", "null"},
           "not a model or state");
    const Result typo =
        eventide({"info", recording()}, {.environment = {{"EVENTIDE_RUN_FPSS", "3"}}});
    EXPECT_NE(typo.error.find("unknown variable EVENTIDE_RUN_FPSS in the environment; did you mean "
                              "EVENTIDE_RUN_FPS?"),
              std::string::npos)
        << typo.error;
    EXPECT_NE(eventide({"convert", recording(), "none.txt", "--filter", "time:900s..901s"})
                  .error.find("wrote 0 events"),
              std::string::npos);
}

TEST_F(WrongUsage, AStampWantsARawStream) {
    expect(2, {"run", recording(), "--out", "a.y4m", "--stamp"}, "--stamp: expected a raw stream");
}

TEST_F(WrongUsage, AConfigurationFileIsHeldToItsKeys) {
    write_text(temp_ / "c.toml", "[run]\nfps = 50\nfsp = 3\n");
    expect(2, {"run", recording(), "--out", "null", "--config", "c.toml"}, "c.toml:3");
    write_text(temp_ / "c.toml", "[run]\nfps = 50\nout = \"a/\"\n");
    EXPECT_EQ(eventide({"run", recording(), "--config", "c.toml"}).exit_code, 0);
    EXPECT_NEAR(double(column(temp_ / "a/timestamps.csv", 0).size()), 20, 1);
    const Result shown =
        eventide({"run", "--config", "c.toml", "--size", "2x", "--print-config"},
                 {.environment = {{"EVENTIDE_RUN_LOOKAHEAD", "1"}, {"EVENTIDE_RUN_FPS", "60"}}});
    EXPECT_EQ(shown.exit_code, 0) << shown.error;
    for (const char* part : {"# flag --size", "# environment EVENTIDE_RUN_FPS", "fps = \"60\"",
                             "# file c.toml:3", "# default"})
        EXPECT_NE(shown.output.find(part), std::string::npos) << part << "\n" << shown.output;
}

TEST_F(WrongUsage, TheLastFlagCountsAndAFlagTakesBackWhatTheEnvironmentSays) {
    const Result shown =
        eventide({"run", "--fps", "20", "--fps", "60", "--no-overwrite", "--print-config"},
                 {.environment = {{"EVENTIDE_RUN_OVERWRITE", "true"}}});
    EXPECT_EQ(shown.exit_code, 0) << shown.error;
    for (const char* line : {"\nfps = \"60\"", "\noverwrite = false"})
        EXPECT_NE(shown.output.find(line), std::string::npos) << line << "\n" << shown.output;
    write_text(temp_ / "a.toml", "[run]\nfps = 10\n");
    write_text(temp_ / "b.toml", "[run]\nfps = 30\n");
    const Result of_files =
        eventide({"run", "--config", "a.toml", "--config", "b.toml", "--print-config"});
    EXPECT_NE(of_files.output.find("\nfps = \"30\""), std::string::npos) << of_files.error;
    expect(2,
           {"run", recording(), "--out", "null", "--states-out", "states/", "--states-at", "100ms",
            "--states-at", "100ms"},
           "--states-at 100ms: expected times that ascend");
}

}  // namespace
}  // namespace eventide::test
