// The loop as a whole, at a size that takes seconds.
#include "src/core/error.h"
#include "tests/apps/train/tiny_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <numeric>
#include <sstream>

namespace eventide {
namespace {

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

TEST(Training, TheFinishedModelIsWholeAndSaysWhatItIs) {
    const fs::path out = empty_folder("exports");
    TrainOptions options = tiny_options(out);
    options.steps = 3;
    options.validation_scenes = 2;
    options.validation_windows = 8;
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

TEST(Training, OnlyTheWeightsThatAreNamedLearn) {
    TrainOptions options = tiny_options(empty_folder("part"));
    options.steps = 4;
    options.train_only = {"renderer."};
    const auto run = trainer(options);
    const Tensors before = run->finished_model().weights;
    train(*run);
    const Tensors after = run->finished_model().weights;
    for (const auto& [name, tensor] : before)
        EXPECT_EQ(tensor.values == after.at(name).values, !name.starts_with("renderer.")) << name;
}

TEST(Training, WhatNoRunCanBeMadeOfIsRefusedBeforeItBegins) {
    const TrainOptions good = tiny_options(empty_folder("refused"));
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"--threads", "0"},
             {"--streams", "0"},
             {"--groups", "0"},
             {"--crop", "1"},
             {"--patch", "10"},
             {"--points-per-pixel", "0.5"},
             {"--train-only", "renderer.,rendrer."},
             {"--event-windows", "0"},
             {"--rendered", "0"},
             {"--rendered", "5"},
             {"--validation-crop", "10", "--validation-scenes", "2"},
             {"--validation-windows", "4", "--validation-scenes", "2"},
             // No model file holds these networks.
             {"--recurrent", "1,0,0"},
             {"--recurrent", "1"},
             {"--gate-radius", "65"},
             {"--latent-stride", "3"},
             {"--teacher-views", "3"},
             {"--teacher-share", "1.5"},
             {"--steps", "-1"},
             {"--minutes", "-1"},
             {"--rate", "-0.001"},
             {"--final-rate", "1.5"},
             {"--constant-share", "1.5"},
             {"--warm-up", "-2"},
             {"--clip", "0"},
             {"--ema", "1.5"},
             {"--log-every", "0"},
             {"--lpips-frames", "0"},
             {"--unfold", "2"}}) {
        TrainOptions options = good;
        OptionTable{options}.parse(words);
        try {
            trainer(options);
            ADD_FAILURE() << words[0] << " " << words[1] << " was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            std::string name = words[0].substr(2);
            std::ranges::replace(name, '-', '_');
            std::string text = error.what();
            std::ranges::replace(text, '-', '_');
            EXPECT_NE(text.find(name), std::string::npos) << error.what();
        }
    }
    EXPECT_TRUE(fs::is_empty(good.out)) << "a run was begun";
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

/// The first four event windows count nothing.
TEST(Training, AShortSceneIsJudgedByTheFramesThatCount) {
    const TrainOptions options = tiny_options("");
    DataSettings data = options.data;
    data.bins = options.model.bins;
    const Parameters parameters = initial_parameters(options.model, 1, torch::kCPU);
    for (const int event_windows : {5, 6}) {
        const Validation validation{{.scenes = 1, .event_windows = event_windows, .crop = 32},
                                    data,
                                    few_textures(),
                                    torch::kCPU};
        const auto scores = validation.judge(options.model, parameters, 0, options.loss, nullptr);
        EXPECT_GT(scores.means[0], 0) << event_windows;
    }
}

/// As a full disk and a killed run leave it.
TEST(Training, ALogThatWasCutShortGoesOnInALineOfItsOwn) {
    for (const std::string left : {"", "step,minutes,rate,l1\n1,0.1,0."}) {
        const fs::path out = empty_folder("cut_log");
        std::ofstream{out / "log.csv"} << left;
        TrainOptions options = tiny_options(out);
        options.log_every = 1;
        options.steps = 2;
        train(*trainer(options));
        std::ifstream in{out / "log.csv"};
        std::vector<std::string> begins;
        for (std::string line; std::getline(in, line);)
            begins.push_back(line.substr(0, line.find(',')));
        const std::vector<std::string> expected =
            left.empty() ? std::vector<std::string>{"step", "1", "2"}
                         : std::vector<std::string>{"step", "1", "1", "2"};
        EXPECT_EQ(begins, expected);
    }
}

TEST(Training, StepsWithoutAFiniteGradientAreCountedThroughAResumption) {
    constexpr std::size_t kSkipped = 12;
    TrainOptions options = tiny_options(empty_folder("skips"));
    options.log_every = 1;
    options.loss.l1 = std::numeric_limits<double>::infinity();
    options.steps = 2;
    train(*trainer(options));
    options.resume = (fs::path{options.out} / "checkpoint.safetensors").string();
    options.steps = 4;
    train(*trainer(options));
    EXPECT_EQ(logged(options.out, kSkipped), (std::vector<double>{1, 2, 3, 4}));
}

/// Streams of one share or of two, of which all images count.
TEST(Training, LpipsLooksAtPatchesBetweenThePixelsAloneWhereItIsToldTo) {
    const fs::path npz =
        fs::path{EVENTIDE_SOURCE_DIR} / "../shared/data/perceptual/lpips_squeeze_v0.1.npz";
    if (!fs::exists(npz)) GTEST_SKIP() << "needs " << npz;
    const auto lpips_of = [&](bool looks_on_pixels, double on_pixels) {
        const fs::path out = empty_folder("looks");
        TrainOptions options = tiny_options(out);
        options.steps = 5;
        options.lpips = npz;
        options.lpips_on_pixels = looks_on_pixels;
        options.data.whole_probability = on_pixels;
        train(*trainer(options));
        return logged(out, 5).front();
    };
    EXPECT_GT(lpips_of(true, 1), 0);
    EXPECT_EQ(lpips_of(false, 1), 0);
    EXPECT_EQ(lpips_of(false, 0), lpips_of(true, 0));
    EXPECT_GT(lpips_of(false, 0), 0);
}

TEST(Training, SharesOfAStepAreItsBatch) {
    const auto run = [](const char* name, int threads, int streams) {
        TrainOptions options = tiny_options(empty_folder(name));
        options.threads = threads;
        options.streams = streams;
        options.data.warm_windows = 0;
        options.log_every = 1;
        options.steps = 2;
        train(*trainer(options));
        return fs::path{options.out};
    };
    const fs::path two = run("two_shares", 2, 1), one = run("one_share", 1, 2);
    // From L1 (3) to the gradient's norm (10).
    for (std::size_t column = 3; column <= 10; ++column) {
        const auto a = logged(two, column), b = logged(one, column);
        ASSERT_EQ(a.size(), 2U);
        for (std::size_t i = 0; i < 2; ++i)
            EXPECT_NEAR(a[i], b[i], 1e-3 * std::abs(b[i]) + 1e-4) << "column " << column;
    }
}

TEST(Training, TheRateRisesStaysAndFallsAlongACosine) {
    TrainOptions options = tiny_options(empty_folder("rate"));
    options.steps = 20;
    options.log_every = 1;
    options.warm_up = 4;
    options.learning_rate = 1e-3;
    options.constant_share = .5;
    options.final_rate = .02;
    train(*trainer(options));
    const auto rate = logged(options.out, 2);
    ASSERT_EQ(rate.size(), 20U);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(rate[i], 2e-4 * double(i + 1), 1e-9) << i;
    for (std::size_t i = 4; i <= 10; ++i) EXPECT_NEAR(rate[i], 1e-3, 1e-9) << i;
    EXPECT_NEAR(rate[15], 1e-3 * (.02 + .98 / 2), 1e-8) << "half of the way down";
    const double at_last = .5 * (1 + std::cos(.9 * std::numbers::pi));
    EXPECT_NEAR(rate[19], 1e-3 * (.02 + .98 * at_last), 1e-8);
}

}  // namespace
}  // namespace eventide
