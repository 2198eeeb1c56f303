// The command line of eventide-train.
#include "apps/train/options.h"
#include "apps/train/sound_options.h"
#include "src/core/error.h"
#include "src/nn/safetensors.h"
#include "tests/apps/train/tiny_run.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

namespace eventide {
namespace {

using testing::HasSubstr;

TEST(Options, WhatIsRecordedCanBeReadBack) {
    TrainOptions first, second;
    OptionTable table{first}, other{second};
    table.parse(
        {"--widths", "8,16", "--rate", "0.002", "--episode", "10,20", "--encoder", "thesis"});
    std::istringstream lines{table.record()};
    std::vector<std::string> words;
    for (std::string line; std::getline(lines, line);) {
        const auto space = line.find(' ');
        words.insert(words.end(), {line.substr(0, space), line.substr(space + 1)});
    }
    other.parse(words);
    EXPECT_EQ(other.record(), table.record());
    EXPECT_EQ(second.model.widths, (std::vector{8, 16}));
    EXPECT_EQ(second.model.encoder, EncoderKind::thesis);
}

/// Who goes on from a checkpoint has the numbers that it began with.
TEST(Options, NumbersAreRecordedToTheirLastDigit) {
    TrainOptions first, second;
    OptionTable table{first};
    table.parse({"--rate", "0.00123456789012", "--turn", "0,3.141592653589793"});
    std::istringstream lines{table.record()};
    for (std::string line; std::getline(lines, line);) {
        const auto space = line.find(' ');
        OptionTable{second}.parse({line.substr(0, space), line.substr(space + 1)});
    }
    EXPECT_EQ(second.learning_rate, first.learning_rate);
    EXPECT_EQ(second.data.scene.wander.turn.high, first.data.scene.wander.turn.high);
}

TEST(Options, AWrongWordIsRefusedByName) {
    TrainOptions options;
    OptionTable table{options};
    for (const std::vector<std::string>& words : {std::vector<std::string>{"--streams", "many"},
                                                  {"--nonsense", "1"},
                                                  {"--rate"},
                                                  {"--card", "two\nlines"}}) {
        try {
            table.parse(words);
            ADD_FAILURE() << words[0] << " was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_NE(std::string{error.what()}.find(words[0]), std::string::npos) << error.what();
        }
    }
}

/// So that training goes on from them: one for each MODEL of scripts/train.sh, and the thesis'.
TEST(Options, ThoseOfTheRepositorysCheckpointsAreKnown) {
    std::set<std::string> checkpoints;
    for (const auto& entry :
         std::filesystem::directory_iterator{EVENTIDE_SOURCE_DIR "/config/models/checkpoints"}) {
        std::istringstream lines{read_safetensors(entry.path()).metadata.at("options")};
        TrainOptions options;
        OptionTable table{options};
        for (std::string line; std::getline(lines, line);) {
            const auto space = line.find(' ');
            EXPECT_NO_THROW(table.parse({line.substr(0, space), line.substr(space + 1)}))
                << entry.path() << ": " << line;
        }
        checkpoints.insert(entry.path().stem());
    }
    EXPECT_EQ(checkpoints,
              (std::set<std::string>{"default", "default_up", "small", "small_up", "thesis"}));
}

/// What a run with these files says; empty where it takes them.
std::string refusal(TrainOptions options, const fs::path& folder) {
    options.out = folder / "run";
    try {
        sound(options);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        return error.what();
    }
    return {};
}

TEST(Options, WhatARunWritesIsNothingThatItReads) {
    const fs::path folder = empty_folder("files");
    const std::string teacher = folder / "teacher", link = folder / "link";
    std::ofstream{teacher} << "a model";
    fs::create_hard_link(teacher, link);
    TrainOptions options = tiny_options(folder / "run");
    options.overwrite = true;
    for (std::string TrainOptions::*output : {&TrainOptions::export_file, &TrainOptions::keep})
        for (std::string TrainOptions::*input :
             {&TrainOptions::teacher, &TrainOptions::initial, &TrainOptions::lpips,
              &TrainOptions::textures, &TrainOptions::validation_textures}) {
            TrainOptions both = options;
            both.*output = link;
            EXPECT_EQ(refusal(both, folder), "");
            both.*input = teacher;
            EXPECT_THAT(refusal(both, folder), HasSubstr(link + ": is the same file as --"));
        }
    options.export_file = options.keep = folder / "new";
    EXPECT_THAT(refusal(options, folder), HasSubstr("--keep " + options.keep + ": is the same"));
    options.export_file = folder / "run" / "best.safetensors";
    EXPECT_THAT(refusal(options, folder), HasSubstr("is the same file as --out"));
}

TEST(Options, ACheckpointThatARunGoesOnFromMayBeKeptAnew) {
    const fs::path folder = empty_folder("goes_on");
    TrainOptions options = tiny_options(folder / "run");
    options.resume = options.keep = folder / "kept";
    std::ofstream{options.keep} << "a checkpoint";
    EXPECT_THAT(refusal(options, folder), HasSubstr("kept"));
    options.overwrite = true;
    EXPECT_EQ(refusal(options, folder), "");
    options.export_file = options.resume;
    options.keep = "";
    EXPECT_THAT(refusal(options, folder), HasSubstr("is the same file as --resume"));
    fs::create_directory(folder / "run");
    options.resume = folder / "run" / "checkpoint.safetensors";
    std::ofstream{options.resume} << "a checkpoint";
    EXPECT_EQ(refusal(options, folder), "") << "of its own folder";
}

TEST(Options, FilesAreReplacedOnlyWhereThatIsAskedFor) {
    const fs::path folder = empty_folder("replaces");
    TrainOptions options = tiny_options(folder / "run");
    options.export_file = folder / "model";
    EXPECT_EQ(refusal(options, folder), "");
    std::ofstream{options.export_file} << "a model";
    EXPECT_THAT(refusal(options, folder), HasSubstr(options.export_file));
    options.overwrite = true;
    EXPECT_EQ(refusal(options, folder), "");
    options.export_file = folder / "nowhere" / "model";
    EXPECT_THAT(refusal(options, folder), HasSubstr("expected a folder that exists")) << "in time";
}

}  // namespace
}  // namespace eventide
