// eventide-train: makes the models that eventide runs. docs/training.md tells how.
#include "apps/train/trainer.h"
#include "src/core/error.h"
#include "src/core/second_signal.h"
#include "src/io/output_file.h"
#include "src/simulate/scene/texture_pack.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <iostream>
#include <sstream>

namespace {

using namespace eventide;

std::atomic<bool> stop_asked{false};
FirstSignal first_signal;

/// The first asks for a clean end; a second wish to stop ends it at once.
void ask_to_stop(int signal) {
    stop_asked = true;
    if (first_signal.take(signal) != StopWish::second) return;
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

std::shared_ptr<const TextureLibrary> library(const std::string& pack, std::uint64_t seed) {
    if (pack.empty()) return procedural_textures(200, 256, seed);
    return textures_from_pack(pack);
}

/// Options of a checkpoint come first, so that those given on the command line win.
void read_options(const std::vector<std::string>& words, OptionTable& table,
                  TrainOptions& options) {
    table.parse(words);
    if (options.resume.empty()) return;
    const std::string checkpoint = options.resume;
    std::istringstream lines{checkpoint_options(checkpoint)};
    for (std::string line; std::getline(lines, line);) {
        const auto space = line.find(' ');
        if (line.starts_with("--") && space != line.npos)
            table.set(line.substr(2, space - 2), line.substr(space + 1));
    }
    table.parse(words);
}

void train(const TrainOptions& options, const std::string& record) {
    Trainer trainer{options, library(options.textures, 1), library(options.validation_textures, 2),
                    [](const std::string& line) { std::cout << line << std::endl; }};
    write_file(std::filesystem::path{options.out} / "options.txt", record, true);
    trainer.run(stop_asked);
    if (!options.keep.empty()) trainer.keep(options.keep);
    if (!options.export_file.empty())
        save_model(options.export_file, trainer.finished_model(), options.overwrite);
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + 1, argv + argc);
    TrainOptions options;
    OptionTable table{options};
    if (!words.empty() && (words[0] == "--help" || words[0] == "-h")) {
        std::cout << table.help();
        return 0;
    }
    try {
        read_options(words, table, options);
        std::signal(SIGINT, ask_to_stop);
        std::signal(SIGTERM, ask_to_stop);
        train(options, table.record());
    } catch (const Error& error) {
        std::cerr << "eventide-train: " << error.what() << "\n";
        return int(error.kind());
    } catch (const std::exception& error) {
        std::cerr << "eventide-train: " << error.what() << "\n";
        return int(ErrorKind::failed);
    }
    return 0;
}
