// The loop as a whole, at a size that takes seconds.
#include "src/core/error.h"
#include "src/train/trainer.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

namespace eventide {
namespace {

namespace fs = std::filesystem;

fs::path empty_folder(const std::string& name) {
    const fs::path folder = fs::path{testing::TempDir()} / ("eventide_train_" + name);
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

TrainOptions tiny_options(const fs::path& out) {
    TrainOptions o;
    o.model.bins = 2;
    o.model.widths = {8, 8};
    o.model.recurrent = {1, 1};
    o.model.res_blocks = 1;
    o.model.latent = 4;
    o.model.mlp = {16};
    o.data.crop = o.data.patch = 32;
    o.data.frames = 4;
    o.data.rendered = 3;
    o.data.episode = {8, 24};
    o.precision = "f32";
    o.threads = 2;
    o.lanes = 1;
    o.groups = 2;
    o.validation_scenes = 0;
    o.log_every = 5;
    o.warm_up = 5;
    o.learning_rate = 3e-3;
    o.steps = 100;
    o.out = out.string();
    return o;
}

std::shared_ptr<const TextureLibrary> textures() {
    static const auto library = procedural_textures(8, 64, 1);
    return library;
}

std::unique_ptr<Trainer> trainer(TrainOptions options) {
    return std::make_unique<Trainer>(options, textures(), textures(), [](const std::string&) {});
}

void train(Trainer& trainer) {
    const std::atomic<bool> stop{false};
    trainer.run(stop);
}

std::vector<double> logged(const fs::path& folder, std::size_t column) {
    std::ifstream in{folder / "log.csv"};
    std::vector<double> values;
    std::string line;
    for (std::getline(in, line); std::getline(in, line);) {
        std::istringstream cells{line};
        std::string cell;
        for (std::size_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
        values.push_back(std::stod(cell));
    }
    return values;
}

TEST(Training, AFewStepsMakeTheErrorSmaller) {
    const fs::path out = empty_folder("learns");
    train(*trainer(tiny_options(out)));
    const auto l1 = logged(out, 3), nll = logged(out, 6);
    ASSERT_EQ(l1.size(), 20U);
    const auto mean = [](const std::vector<double>& v, std::size_t from) {
        return std::accumulate(v.begin() + long(from), v.begin() + long(from) + 6, 0.0) / 6;
    };
    EXPECT_LT(mean(l1, 14) + 0.1 * mean(nll, 14), mean(l1, 0) + 0.1 * mean(nll, 0));
    EXPECT_TRUE(fs::exists(out / "checkpoint.safetensors"));
}

/// A run of `options.steps` in one go, and one that stops after `stop_at`: the same bit for bit.
/// Gives the first.
std::unique_ptr<Trainer> expect_stopping_changes_nothing(TrainOptions options, int stop_at) {
    const fs::path parts = empty_folder("parts");
    const int steps = options.steps;
    options.constant_share = 1;  // the rate must not depend on how often the run stops
    auto expected = trainer(options);
    train(*expected);

    options.out = parts.string();
    options.steps = stop_at;
    train(*trainer(options));
    options.resume = (parts / "checkpoint.safetensors").string();
    options.steps = steps;
    const auto resumed = trainer(options);
    EXPECT_EQ(resumed->steps(), stop_at);
    train(*resumed);
    for (const auto& [name, values] : expected->parameters())
        EXPECT_EQ((values - resumed->parameters().at(name)).abs().max().item<float>(), 0) << name;
    return expected;
}

TEST(Training, ARunThatStoppedGoesOnAsIfItHadNot) {
    TrainOptions options = tiny_options(empty_folder("whole"));
    options.steps = 12;
    expect_stopping_changes_nothing(options, 5);
}

TEST(Training, ADeeperNetworkBeginsWithWhatAShallowerOneHasLearned) {
    const fs::path out = empty_folder("inherits");
    TrainOptions options = tiny_options(out / "shallow");
    options.steps = 3;
    const auto shallow = trainer(options);
    train(*shallow);
    save_model(out / "shallow.safetensors", shallow->finished_model());

    options.model.widths = {8, 8, 8};
    options.model.recurrent = {1, 1, 1};
    options.out = (out / "deep").string();
    for (const char* file : {"shallow.safetensors", "shallow/checkpoint.safetensors"}) {
        options.initial = (out / file).string();
        const auto deep = trainer(options);
        for (const auto& [name, values] : shallow->finished_model().weights) {
            const torch::Tensor inherited = deep->parameters().at(name).detach().cpu();
            EXPECT_EQ(to_tensor(inherited).values, values.values) << file << " " << name;
        }
        // The new join: its own level through the middle, a tenth of a start for the rest.
        const torch::Tensor join = deep->parameters().at("encoder.up.1.weight").detach();
        EXPECT_GT(join[3][8 + 3][1][1].item<float>(), 0.8F);
        EXPECT_LT(join[3][8 + 4].abs().max().item<float>(), 0.2F);
        EXPECT_EQ(deep->steps(), 0);
        train(*deep);
    }
}

TEST(Training, WeightsOfAnotherNetworkAreRefused) {
    const fs::path out = empty_folder("foreign");
    TrainOptions options = tiny_options(out);
    options.model.widths = {6, 6};
    options.model.mlp = {12};
    options.model.latent = 5;
    save_model(out / "other.safetensors",
               {options.model,
                to_tensors(initial_parameters(options.model, 1, torch::Device{torch::kCPU}))});
    options = tiny_options(out);
    options.model.bins = 3;
    options.initial = (out / "other.safetensors").string();
    try {
        trainer(options);
        FAIL() << "expected an error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_NE(std::string{error.what()}.find("other.safetensors"), std::string::npos);
    }
    options.resume = options.initial;
    EXPECT_THROW(trainer(options), Error);
}

TEST(Training, TheFinishedModelIsWholeAndSaysWhatItIs) {
    const fs::path out = empty_folder("exports");
    TrainOptions options = tiny_options(out);
    options.steps = 3;
    options.validation_scenes = 2;
    options.validation_frames = 8;
    options.validation_crop = 32;
    const auto run = trainer(options);
    train(*run);
    save_model(out / "model.safetensors", run->finished_model());
    const Model model = load_model(out / "model.safetensors");
    EXPECT_GT(model.config.sigma_scale, 0);
    EXPECT_NE(model.config.card.find("3 steps"), std::string::npos);
    EXPECT_NE(model.config.card.find("--widths 8,8"), std::string::npos);
    EXPECT_EQ(model.config.card.find(out.string()), std::string::npos) << "no names of files";
    EXPECT_TRUE(fs::exists(out / "learning_curve.svg"));
    EXPECT_TRUE(fs::exists(out / "best.safetensors"));
}

TEST(Training, AnInputThatIsNotUsedHasNoWeightInTheModel) {
    const fs::path out = empty_folder("inputs");
    TrainOptions options = tiny_options(out);
    options.steps = 4;
    options.inputs = {"polarity", "since"};
    const auto run = trainer(options);
    train(*run);
    const auto per_channel =
        run->parameters().at("encoder.in.weight").detach().abs().sum(torch::IntArrayRef{0, 2, 3});
    ASSERT_EQ(per_channel.size(0), 9);  // B = 2
    for (const int channel : {0, 4, 8}) EXPECT_GT(per_channel[channel].item<float>(), 0) << channel;
    for (const int channel : {1, 2, 3, 5, 6, 7})
        EXPECT_EQ(per_channel[channel].item<float>(), 0) << channel;
    options.inputs = {"colour"};
    EXPECT_THROW(trainer(options), Error);
}

TEST(Training, ANetworkThatIsFedItsOwnPictureGoesOnAsIfItHadNotStopped) {
    for (const char* kind : {"input", "change", "physical"}) {
        SCOPED_TRACE(kind);
        TrainOptions options = tiny_options(empty_folder("fed_whole"));
        OptionTable{options}.set("feedback", kind);
        options.steps = 10;
        const auto whole = expect_stopping_changes_nothing(options, 4);
        const auto& first = whole->parameters().at("encoder.in.weight");
        EXPECT_EQ(first.size(1), 4 * 2 + 2) << "the picture is one more channel than the events";
    }
}

TEST(Training, ANetworkThatIsFedItsOwnPictureIsNotExported) {
    TrainOptions options = tiny_options(empty_folder("fed_export"));
    OptionTable{options}.set("feedback", "change");
    options.export_file = "model.safetensors";
    EXPECT_THROW(trainer(options), Error);
}

/// In an empty world nothing is asked for: a change of 0, a factor of 1.
TEST(Feedback, APictureThatNothingChangesIsHandedOnAsItIs) {
    const ModelConfig config = tiny_options({}).model;
    for (const Feedback feedback : {Feedback::change, Feedback::physical}) {
        Parameters parameters = with_feedback(initial_parameters(config, 1, torch::kCPU), feedback);
        const torch::NoGradGuard none;
        for (auto& [name, values] : parameters)
            if (name.starts_with("renderer.mlp.1")) values.zero_();  // the last layer
        torch::Tensor picture = torch::rand({2, 1, 12, 9}) - kFeedbackGrey;
        const torch::Tensor z = torch::zeros({2, config.latent, 12, 9});
        torch::Tensor next = next_picture(feedback, config, parameters, z, z, picture);
        EXPECT_LT((next - picture).abs().max().item<float>(), 1e-6) << int(feedback);
        parameters.at("renderer.mlp.1.bias")[0] = .25;
        next = next_picture(feedback, config, parameters, z, z, picture);
        EXPECT_GT((next - picture).min().item<float>(), -1e-6) << "brighter, or white already";
        EXPECT_GT((next - picture).mean().item<float>(), .05);
    }
}

TEST(Feedback, APictureIsReadBetweenItsPixelsAndBetweenItsInstants) {
    torch::Tensor ramp = torch::arange(6, torch::kFloat).view({1, 1, 1, 6}).expand({1, 1, 4, 6});
    const Rendered nothing{torch::zeros({1, 2, 3}), torch::zeros({1, 2, 3})};
    const PatchGrid points{.y = {0, 2.5}, .x = {.25, 3, 9}};  // the last beyond the border
    const auto mu = [&](const torch::Tensor& later) {
        const FedPictures fed{ramp, later, torch::full({1}, .25)};
        return apply_feedback(Feedback::change, {}, nothing, {fed}, points).mu - kFeedbackGrey;
    };
    EXPECT_TRUE(torch::allclose(mu({})[0][1], torch::tensor({.25F, 3.F, 5.F})));
    EXPECT_TRUE(torch::allclose(mu(ramp + 1)[0][0], torch::tensor({.5F, 3.25F, 5.25F})));
}

TEST(Training, ACheckpointOfAnotherNetworkIsRefusedByName) {
    const fs::path out = empty_folder("refuses");
    TrainOptions options = tiny_options(out);
    options.steps = 1;
    train(*trainer(options));
    options.resume = (out / "checkpoint.safetensors").string();
    options.model.widths = {8, 12};
    try {
        trainer(options);
        FAIL() << "a checkpoint of other widths was taken";
    } catch (const Error& error) {
        EXPECT_NE(std::string{error.what()}.find("encoder."), std::string::npos) << error.what();
    }
}

TEST(Lane, IsTheSameHoweverOftenTheRunStops) {
    DataSettings settings = tiny_options({}).data;
    settings.thesis_share = .5;
    const LanePlace place{.lane = 3, .group = 1, .groups = 2};
    Lane whole{settings, textures(), place, 0};
    std::vector<LaneWindow> windows;
    for (int i = 0; i < 12; ++i) windows.push_back(whole.next());
    int fresh = 0;
    for (const int at : {0, 1, 5, 9}) {
        // The lane's window i is the run's window 2 i + 1.
        LaneWindow again = Lane{settings, textures(), place, 2 * at}.next();
        const LaneWindow& expected = windows[std::size_t(at)];
        EXPECT_EQ(again.fresh, expected.fresh);
        EXPECT_EQ(again.f, expected.f);
        EXPECT_EQ(again.grids, expected.grids);
        EXPECT_EQ(again.truth, expected.truth);
    }
    for (const LaneWindow& window : windows) fresh += window.fresh;
    EXPECT_GT(fresh, 1) << "scenes end";
    EXPECT_LT(fresh, 12) << "scenes last longer than a window";
}

TEST(Lane, ThesisScenesShowThePictureWhateverTheLight) {
    DataSettings settings = tiny_options({}).data;
    settings.scene.target_white = {.5, .5};
    settings.scene.target_white_below_one = 1;  // of all other scenes
    const auto brightest = [&] {
        Lane lane{settings, textures(), {}, 0};
        float most = 0;
        for (int i = 0; i < 8; ++i)
            for (const auto& truth : lane.next().truth)
                most = std::max(most, *std::ranges::max_element(truth.values()));
        return most;
    };
    EXPECT_LE(brightest(), .5f);
    settings.thesis_share = 1;
    EXPECT_GT(brightest(), .6f);
}

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

TEST(Options, AWrongWordIsRefusedByName) {
    TrainOptions options;
    OptionTable table{options};
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"--lanes", "many"}, {"--nonsense", "1"}, {"--rate"}}) {
        try {
            table.parse(words);
            ADD_FAILURE() << words[0] << " was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_NE(std::string{error.what()}.find(words[0]), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace eventide
