// Training runs of a size that takes seconds.
#pragma once

#include "apps/train/trainer.h"

#include <filesystem>
#include <memory>
#include <string>

namespace eventide {

namespace fs = std::filesystem;

/// A folder of this test program's own, empty.
fs::path empty_folder(const std::string& name);

/// Two levels of 8 channels, crops of 32 px, two threads, 100 steps, nothing judged.
TrainOptions tiny_options(const fs::path& out);

/// A few made-up images, the same for all runs.
std::shared_ptr<const TextureLibrary> few_textures();

std::unique_ptr<Trainer> trainer(const TrainOptions& options);

/// Until the budget is spent.
void train(Trainer& trainer);

/// A run of `options.steps` in one go, and one that stops after `stop_at`: the same bit for bit.
/// Gives the first.
std::unique_ptr<Trainer> expect_stopping_changes_nothing(TrainOptions options, int stop_at);

}  // namespace eventide
