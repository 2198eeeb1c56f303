// The command line of eventide-train.
#include "apps/train/options.h"
#include "src/core/error.h"
#include "src/nn/safetensors.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <string>

namespace eventide {
namespace {

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

}  // namespace
}  // namespace eventide
