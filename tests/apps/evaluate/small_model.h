// A network that has learned nothing and a simulation that is over soon: enough to run everything.
#pragma once

#include "apps/evaluate/evaluate.h"
#include "src/model/model_file.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace eventide {

inline EvaluateSettings small_model() {
    ModelConfig config;
    config.bins = 2;
    config.widths = {8, 8};
    config.recurrent = {1, 1};
    config.res_blocks = 1;
    config.latent = 8;
    config.mlp = {16};
    // ctest runs tests at the same time; each has its own file.
    const std::string unique =
        testing::UnitTest::GetInstance()->current_test_info()->test_suite_name() +
        std::string("_") + testing::UnitTest::GetInstance()->current_test_info()->name();
    EvaluateSettings settings;
    settings.model = std::filesystem::path{testing::TempDir()} /
                     ("eventide_evaluate_" + unique + ".safetensors");
    save_model(settings.model, test::random_model(config, 1));
    settings.engine.engine = Engine::plain;
    return settings;
}

inline SimulatedSettings small_simulation() {
    SimulatedSettings what;
    what.sequences = 2;
    what.event_windows = 9;
    what.width = 36;
    what.height = 28;
    what.skip_frames = 3;
    what.score_every = 1;
    return what;
}

}  // namespace eventide
