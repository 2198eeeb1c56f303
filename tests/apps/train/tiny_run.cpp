#include "tests/apps/train/tiny_run.h"

#include <gtest/gtest.h>

namespace eventide {

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
    o.data.event_windows = 4;
    o.data.rendered = 3;
    o.data.episode = {8, 24};
    o.precision = Precision::f32;
    o.threads = 2;
    o.streams = 1;
    o.groups = 2;
    o.validation_scenes = 0;
    o.log_every = 5;
    o.warm_up = 5;
    o.learning_rate = 3e-3;
    o.steps = 100;
    o.out = out.string();
    return o;
}

std::shared_ptr<const TextureLibrary> few_textures() {
    static const auto library = procedural_textures(8, 64, 1);
    return library;
}

std::unique_ptr<Trainer> trainer(const TrainOptions& options) {
    return std::make_unique<Trainer>(options, few_textures(), few_textures(),
                                     [](const std::string&) {});
}

void train(Trainer& trainer) {
    const std::atomic<bool> stop{false};
    trainer.run(stop);
}

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
    // Nobody validates, so that the finished model is the running mean.
    const Tensors mean = resumed->finished_model().weights;
    for (const auto& [name, tensor] : expected->finished_model().weights)
        EXPECT_EQ(tensor.values, mean.at(name).values) << "running mean of " << name;
    return expected;
}

}  // namespace eventide
