// Runs that stop and go on, and networks that begin with what another has learned.
#include "src/core/error.h"
#include "src/model/encode/encoder.h"
#include "tests/apps/train/tiny_run.h"
#include "tests/model/streams.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

auto train_and_save(const TrainOptions& options, const fs::path& model) {
    auto trained = trainer(options);
    train(*trained);
    save_model(model, trained->finished_model());
    return trained;
}

TEST(Training, ARunThatStoppedGoesOnAsIfItHadNot) {
    TrainOptions options = tiny_options(empty_folder("whole"));
    options.steps = 12;
    // Of a segment whose first window is rendered, the code before it is one of the stopped run's.
    int stop_at = 4;
    while (segment_plan(options.data, stop_at).first_rendered != 0 ||
           segment_plan(options.data, stop_at + 1).first_rendered != 0)
        ++stop_at;
    ASSERT_LT(stop_at, 10);
    expect_stopping_changes_nothing(options, stop_at);
}

TEST(Training, AKeptCheckpointHasNoStreamsAndGoesOn) {
    const fs::path out = empty_folder("keeps");
    TrainOptions options = tiny_options(out);
    options.steps = 3;
    const auto first = trainer(options);
    train(*first);
    const fs::path kept = out / "kept.safetensors";
    first->keep(kept);
    EXPECT_LT(fs::file_size(kept), fs::file_size(out / "checkpoint.safetensors"));
    options.resume = kept.string();
    options.steps = 5;
    const auto second = trainer(options);
    EXPECT_EQ(second->steps(), 3);
    for (const auto& [name, values] : first->parameters())
        EXPECT_TRUE(torch::equal(second->parameters().at(name), values)) << name;
    train(*second);
    EXPECT_EQ(second->steps(), 5);
}

TEST(Training, AResumedRunLeavesOutTheInputsThatItIsToldTo) {
    const fs::path out = empty_folder("narrows");
    TrainOptions options = tiny_options(out);
    options.steps = 3;
    train(*trainer(options));  // with all inputs, and moments of all
    options.resume = (out / "checkpoint.safetensors").string();
    options.inputs = {"polarity", "since"};
    options.steps = 6;
    const auto run = trainer(options);
    train(*run);
    const Tensors mean = run->finished_model().weights;
    const auto used = [&](const torch::Tensor& weight) {
        return weight.detach().abs().sum(torch::IntArrayRef{0, 2, 3});
    };
    for (const auto& per_channel : {used(run->parameters().at("encoder.in.weight")),
                                    used(to_torch(mean.at("encoder.in.weight"), torch::kCPU))}) {
        for (const int channel : {0, 4, 8})
            EXPECT_GT(per_channel[channel].item<float>(), 0) << channel;
        for (const int channel : {1, 2, 3, 5, 6, 7})
            EXPECT_EQ(per_channel[channel].item<float>(), 0) << channel;
    }
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

TEST(Training, ADeeperNetworkBeginsWithWhatAShallowerOneHasLearned) {
    const fs::path out = empty_folder("inherits");
    TrainOptions options = tiny_options(out / "shallow");
    options.steps = 3;
    const auto shallow = train_and_save(options, out / "shallow.safetensors");

    options.model.widths = {8, 8, 8};
    options.model.recurrent = {1, 1, 1};
    for (const char* file : {"shallow.safetensors", "shallow/checkpoint.safetensors"}) {
        options.out = (out / "deep" / file).string();
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

TEST(Training, AWiderEncoderBeginsWithWhatTheNarrowOneComputes) {
    const fs::path out = empty_folder("widens");
    TrainOptions options = tiny_options(out / "narrow");
    options.steps = 3;
    const auto narrow = train_and_save(options, out / "narrow.safetensors");

    options.out = (out / "wide").string();
    options.initial = (out / "narrow.safetensors").string();
    options.model.widths = {12, 16};
    const auto wide = trainer(options);
    const Model models[] = {narrow->finished_model(), wide->finished_model()};
    ASSERT_GT(models[1].weights.at("encoder.gru.0.gates.weight").values.size(),
              models[0].weights.at("encoder.gru.0.gates.weight").values.size());
    constexpr int kWidth = 33, kHeight = 22;
    test::GridStream stream{models[0].config, kHeight, kWidth, 5};
    Encoder encoders[] = {{models[0], kWidth, kHeight, {.engine = Engine::plain}},
                          {models[1], kWidth, kHeight, {.engine = Engine::plain}}};
    for (int k = 0; k < 4; ++k) {
        const VoxelGrid grid = stream.next(test::GridStream::Kind::patch);
        LatentMap expected = encoders[0].make_output(), found = encoders[1].make_output();
        encoders[0].encode(grid, expected);
        encoders[1].encode(grid, found);
        const auto e = expected.values.values(), f = found.values.values();
        ASSERT_EQ(e.size(), f.size());
        for (std::size_t i = 0; i < e.size(); ++i) ASSERT_NEAR(f[i], e[i], 1e-5F) << k << " " << i;
    }
    train(*wide);
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
}

/// Judged every step and at the end.
TrainOptions judged_options(const fs::path& out) {
    TrainOptions options = tiny_options(out);
    options.threads = 1;
    options.validation_scenes = 1;
    options.validation_windows = 8;
    options.validation_crop = 32;
    options.validate_minutes = 0;
    return options;
}

TEST(Training, ARunThatNobodyJudgesGivesItsOwnWeightsNotTheBestOfBefore) {
    TrainOptions options = judged_options(empty_folder("unjudged"));
    options.steps = 2;
    train(*trainer(options));
    options.resume = (fs::path{options.out} / "checkpoint.safetensors").string();
    options.validation_scenes = 0;
    options.steps = 6;
    const auto resumed = trainer(options);
    train(*resumed);
    const Tensors best = load_model(fs::path{options.out} / "best.safetensors").weights;
    const std::string name = "encoder.in.weight";
    EXPECT_NE(resumed->finished_model().weights.at(name).values, best.at(name).values);
}

TEST(Training, ARunThatGoesOnKeepsTheBestOfBefore) {
    TrainOptions options = judged_options(empty_folder("keeps_best"));
    options.steps = 4;
    train(*trainer(options));
    const fs::path best = fs::path{options.out} / "best.safetensors";
    const std::string name = "encoder.in.weight";
    const auto good = load_model(best).weights.at(name).values;
    options.resume = (fs::path{options.out} / "checkpoint.safetensors").string();
    options.learning_rate = 1;  // it only gets worse
    for (const int steps : {6, 8}) {
        options.steps = steps;
        const auto resumed = trainer(options);
        train(*resumed);
        EXPECT_EQ(load_model(best).weights.at(name).values, good) << steps;
        EXPECT_EQ(resumed->finished_model().weights.at(name).values, good) << steps;
    }
}

/// As a repository's checkpoints do (scripts/train.sh).
TEST(Training, ARunThatGoesOnElsewhereHasNothingOfTheFolder) {
    TrainOptions options = judged_options(empty_folder("another_best"));
    options.steps = 2;
    const auto first = trainer(options);
    train(*first);
    const fs::path kept = fs::path{options.out} / "kept.safetensors";
    first->keep(kept);
    TrainOptions other = judged_options(empty_folder("has_a_best"));
    other.learning_rate = .01;
    other.steps = 4;
    train(*trainer(other));
    const std::string name = "encoder.in.weight";
    const auto best = load_model(fs::path{other.out} / "best.safetensors").weights.at(name).values;
    options.out = other.out;
    options.resume = kept.string();
    for (const int scenes : {0, 1}) {
        options.validation_scenes = scenes;
        const auto over = trainer(options);  // nothing is left to do but to write the model
        train(*over);
        EXPECT_NE(over->finished_model().weights.at(name).values, best) << scenes;
    }
}

TEST(Training, ANewRunIsNotWrittenOverAnother) {
    const fs::path out = empty_folder("other");
    TrainOptions options = tiny_options(out);
    options.steps = 1;
    train(*trainer(options));
    const auto before = fs::last_write_time(out / "checkpoint.safetensors");
    try {
        trainer(options);
        FAIL() << "expected an error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_NE(std::string{error.what()}.find("--resume " + (out / "checkpoint").string()),
                  std::string::npos)
            << error.what();
    }
    EXPECT_EQ(fs::last_write_time(out / "checkpoint.safetensors"), before);
}

TEST(Training, ARunBeginsOrGoesOnNotBoth) {
    TrainOptions options = tiny_options(empty_folder("both"));
    options.initial = options.resume = "no-such-file";
    try {
        trainer(options);
        FAIL() << "expected an error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
        EXPECT_NE(std::string{error.what()}.find("--initial"), std::string::npos);
    }
}

}  // namespace
}  // namespace eventide
