// The built program, with a small model and small recordings of the project's own.
#include "tests/system/program_test.h"

#include "src/model/model_file.h"
#include "tests/support/random_model.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>

namespace eventide::test {

namespace {

namespace fs = std::filesystem;

ModelConfig small_config() {
    ModelConfig config;
    config.bins = 2;
    config.widths = {16, 16};
    config.recurrent = {1, 1};
    config.res_blocks = 1;
    config.latent = 16;
    config.mlp = {16};
    config.window = "20ms";
    config.card = "random weights, for tests";
    return config;
}

struct SharedFiles {
    TempFolder folder;

    SharedFiles() {
        save_model(folder / "random.safetensors", test::random_model(small_config(), 1));
        save_model(folder / "default.safetensors", test::random_model(small_config(), 1));
        ModelConfig other = small_config();
        other.widths = {16, 32};
        save_model(folder / "other.safetensors", test::random_model(other, 2));
        const Result made = run({EVENTIDE_PROGRAM, "simulate", "--scene", "demo", "--seconds",
                                 "0.4", "--size", "64x48", "--out", folder / "recording.aedat4"});
        if (made.exit_code != 0)
            throw std::runtime_error("eventide simulate failed: " + made.error);
    }
};

const SharedFiles& shared() {
    static const SharedFiles files;
    return files;
}

}  // namespace

void ProgramTest::SetUpTestSuite() {
    // What the user's own environment says must not change the tests.
    for (const char* name : {"EVENTIDE_CONFIG", "EVENTIDE_MODELS", "NO_COLOR", "DISPLAY",
                             "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"})
        unsetenv(name);
    setenv("XDG_CACHE_HOME", (shared().folder / "cache").c_str(), 1);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    // So much slower that oneDNN's are sometimes taken for quicker, and two runs differ.
    setenv("EVENTIDE_RUN_KERNELS", "own", 1);
#endif
}

Result ProgramTest::eventide(const std::vector<std::string>& arguments,
                             ProcessSettings settings) const {
    return start(arguments, std::move(settings)).wait();
}

Process ProgramTest::start(const std::vector<std::string>& arguments,
                           ProcessSettings settings) const {
    std::vector<std::string> all{EVENTIDE_PROGRAM};
    all.insert(all.end(), arguments.begin(), arguments.end());
    if (settings.folder.empty()) settings.folder = temp_.path().string();
    settings.environment.try_emplace("EVENTIDE_MODELS", shared().folder.path().string());
    return Process{all, std::move(settings)};
}

void ProgramTest::expect(int code, const std::vector<std::string>& arguments,
                         const std::string& words, ProcessSettings settings) const {
    const Result result = eventide(arguments, std::move(settings));
    std::string line = "eventide";
    for (const std::string& argument : arguments) line += " " + argument;
    EXPECT_EQ(result.exit_code, code) << line << "\n" << result.error;
    EXPECT_NE(result.error.find(words), std::string::npos) << line << "\n" << result.error;
    EXPECT_EQ(result.output, "") << line;
}

Result ProgramTest::in_shell(const std::string& script) const {
    std::error_code there_already;
    fs::create_symlink(recording(), temp_ / "recording", there_already);
    fs::create_symlink(model(), temp_ / "model.safetensors", there_already);
    const std::string programs = fs::path{EVENTIDE_PROGRAM}.parent_path().string();
    return run({"bash", "-o", "pipefail", "-c", "PATH=" + programs + ":$PATH; " + script},
               {.environment = {{"EVENTIDE_MODELS", fs::path{model()}.parent_path()}},
                .folder = temp_.path().string()});
}

std::string ProgramTest::model() {
    return shared().folder / "random.safetensors";
}
std::string ProgramTest::wrong_model() {
    return shared().folder / "other.safetensors";
}
std::string ProgramTest::recording() {
    return shared().folder / "recording.aedat4";
}

std::string ProgramTest::probe(const std::string& file, const std::string& stream_entries) {
    const Result result =
        run({"ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries",
             "stream=" + stream_entries, "-of", "csv=p=0", file});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.output;
}

std::vector<long long> ProgramTest::packet_times(const std::string& file) {
    const Result result = run({"ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
                               "packet=pts", "-of", "csv=p=0", file});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    std::istringstream lines{result.output};
    std::vector<long long> times;
    for (std::string line; std::getline(lines, line);) times.push_back(std::stoll(line));
    return times;
}

std::vector<long long> ProgramTest::column(const std::string& file, std::size_t number) {
    std::istringstream lines{read_text(file)};
    std::vector<long long> values;
    std::string line;
    for (std::getline(lines, line); std::getline(lines, line);) {
        std::istringstream cells{line};
        std::string cell;
        for (std::size_t i = 0; i <= number; ++i) std::getline(cells, cell, ',');
        values.push_back(std::stoll(cell));
    }
    return values;
}

}  // namespace eventide::test
