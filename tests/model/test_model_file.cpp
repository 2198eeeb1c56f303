// Model files: what is saved is loaded, and what does not hold together is refused by name.
#include "src/core/error.h"
#include "src/model/model_file.h"
#include "src/model/model_metadata.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <limits>

namespace eventide {
namespace {

using testing::HasSubstr;

std::string refusal(const TensorFile& file) {
    const auto path = std::filesystem::path{testing::TempDir()} /
                      ("model_" + std::to_string(::getpid()) + ".safetensors");
    write_safetensors(path, file);
    std::string said = "accepted";
    try {
        load_model(path);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        said = error.what();
    }
    std::filesystem::remove(path);
    return said;
}

TensorFile good() {
    const Model model = test::random_model(test::small_config(), 1);
    return {format_metadata(model.config), model.weights};
}

TEST(ModelFile, WhatIsSavedIsLoaded) {
    ModelConfig config = test::small_config();
    config.log_sigma_min = -5.5F;
    config.sigma_scale = 1.1F;
    config.sigma_rule = SigmaRule::mixture;
    config.lookaheads = {0, 2};
    config.card = "trained on shapes,\nfor an hour";
    const Model model = test::random_model(config, 1);
    const auto path = std::filesystem::path{testing::TempDir()} /
                      ("saved_" + std::to_string(::getpid()) + ".safetensors");
    save_model(path, model);
    const Model loaded = load_model(path);
    std::filesystem::remove(path);
    EXPECT_EQ(loaded.weights, model.weights);
    EXPECT_EQ(format_metadata(loaded.config), format_metadata(config));
    EXPECT_EQ(encoder_identity(loaded), encoder_identity(model));
    EXPECT_NE(encoder_identity(loaded), encoder_identity(test::random_model(config, 2)));
}

TEST(ModelFile, MetadataThatMakesNoSenseIsRefusedByItsKey) {
    const std::vector<std::pair<std::string, std::string>> bad{
        {"format", "other"},   {"version", "2"},         {"encoder", "transformer"},
        {"bins", "0"},         {"bins", "2.5"},          {"bins", ""},
        {"widths", "8,x"},     {"widths", "8,,8"},       {"widths", "100000"},
        {"recurrent", "1,0"},  {"recurrent", "1,2,1"},   {"latent_stride", "3"},
        {"lookaheads", "0,5"}, {"log_sigma_min", "nan"}, {"log_sigma_min", "3"},
        {"sigma_scale", "-1"}, {"sigma_rule", "median"}, {"mlp", ""},
        {"res_blocks", "-1"},  {"gate_radius", "1e9"},   {"gate_spread", "-1"},
        {"blend", "cubic"},    {"new_key", "1"},         {"reset_gate", "2"},
        {"out_layer", "0"},  // its 5 codes are not the 8 channels of the last map
    };
    for (const auto& [key, value] : bad) {
        TensorFile file = good();
        file.metadata[key] = value;
        EXPECT_THAT(refusal(file), HasSubstr("'" + key + "'")) << value;
    }
    TensorFile file = good();
    file.metadata.erase("latent");
    EXPECT_THAT(refusal(file), HasSubstr("'latent' is missing"));
    EXPECT_EQ(refusal(good()), "accepted");
}

TEST(ModelFile, KeysThatOlderFilesHaveNotGotMayBeMissing) {
    TensorFile file = good();
    file.metadata.erase("gate_spread");
    file.metadata.erase("blend");
    file.metadata.erase("reset_gate");
    file.metadata.erase("out_layer");
    const ModelConfig config = parse_metadata(file.metadata, "old");
    EXPECT_EQ(config.gate_spread, 0);
    EXPECT_EQ(config.blend, Blend::linear);
    EXPECT_TRUE(config.reset_gate && config.out_layer);
    EXPECT_EQ(refusal(file), "accepted");
}

TEST(ModelFile, TensorsThatDoNotFitAreRefusedByName) {
    TensorFile file = good();
    file.tensors.erase("encoder.gru.2.gates.bias");
    EXPECT_THAT(refusal(file), HasSubstr("'encoder.gru.2.gates.bias'"));
    file = good();
    file.tensors["encoder.extra"] = {{1}, {0}};
    EXPECT_THAT(refusal(file), HasSubstr("'encoder.extra'"));
    file = good();
    file.tensors["renderer.mlp.1.weight"].shape = {24, 16};
    EXPECT_THAT(refusal(file), HasSubstr("'renderer.mlp.1.weight': expected shape [16, 24], found "
                                         "[24, 16]"));
    file = good();
    file.tensors["encoder.out.bias"].values[0] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(refusal(file), HasSubstr("'encoder.out.bias'"));
}

TEST(ModelFile, AModelThatDoesNotHoldTogetherIsNotSaved) {
    Model model = test::random_model(test::small_config(), 1);
    model.weights.erase("encoder.in.bias");
    EXPECT_THROW(save_model(testing::TempDir() + "never", model), Error);
}

}  // namespace
}  // namespace eventide
