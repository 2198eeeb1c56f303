// The encoder: fast against plain against double, and what must not change anything.
#include "src/core/error.h"
#include "src/model/encode/encoder.h"
#include "tests/model/engine_choices.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <utility>

namespace eventide {
namespace {

using test::GridStream;
using Kind = GridStream::Kind;

/// Float32 against double over a recurrent run; states are near 1 and a step adds sums of a few
/// hundred products, each rounded to 6e-8, which gates keep from growing.
constexpr double kFloatTolerance = 2e-4;
EngineOptions with(Engine engine, Precision precision = Precision::f32) {
    EngineOptions options;
    options.engine = engine;
    options.precision = precision;
    return options;
}

std::vector<std::pair<int, int>> shapes() {
    return {{1, 1}, {2, 3}, {37, 53}, {64, 33}, {1, 70}};
}

struct Case {
    const char* name;
    ModelConfig config;
};
std::vector<Case> cases() {
    ModelConfig half = test::small_config(), single = test::small_config();
    half.latent_stride = 2;
    half.res_blocks = 0;
    single.widths = {16};
    single.recurrent = {1};
    single.res_blocks = 2;
    ModelConfig light = test::small_config(), wide = light;
    light.reset_gate = light.out_layer = false;
    light.latent = light.widths[0];
    wide.reset_gate = false;
    wide.widths = {9, 20};  // not whole vectors
    wide.recurrent = {1, 1};
    return {{"small", test::small_config()},  {"half", half},   {"single level", single},
            {"default", ModelConfig{}},       {"light", light}, {"light, recurrent below", wide},
            {"thesis", test::thesis_config()}};
}

TEST(Encoder, FastAgreesWithPlainAtEveryShape) {
    for (const Case& c : cases())
        for (const auto& [height, width] : shapes()) {
            const Model model = test::random_model(c.config, 7);
            Encoder plain{model, width, height, with(Engine::plain)};
            std::vector<Encoder> fast;
            for (const test::EngineChoice& choice : test::engine_choices())
                if (!choice.bf16) fast.emplace_back(model, width, height, choice.options);
            GridStream stream{c.config, height, width, 3};
            LatentMap a = plain.make_output(), b = plain.make_output();
            for (int i = 0; i < 4; ++i) {
                const VoxelGrid& grid = stream.next();
                plain.encode(grid, b);
                for (Encoder& encoder : fast) {
                    encoder.encode(grid, a);
                    ASSERT_LE(test::worst(a.values.values(), b.values.values()), kFloatTolerance)
                        << encoder.description() << ", " << c.name << " " << width << "x" << height
                        << " step " << i;
                }
            }
        }
}

/// So many tiles that states are brought into the map group by group, and what holds the next ones
/// is used again: three groups of 32 rows of tiles on either level.
/// Groups of tiles are whole rows, of which the longest are longer than the least group.
TEST(Encoder, FastAgreesWithPlainWhereTilesAreMany) {
    for (const bool reset_gate : {true, false})
        for (const auto& [width, height] : {std::pair{3, 4000}, {1600, 49}}) {
            ModelConfig config = test::small_config();
            config.widths = {4, 4};
            config.recurrent = {1, 1};
            config.reset_gate = reset_gate;
            config.res_blocks = 0;
            const Model model = test::random_model(config, 7);
            Encoder plain{model, width, height, with(Engine::plain)},
                fast{model, width, height, with(Engine::fast)};
            GridStream stream{config, height, width, 3};
            LatentMap a = fast.make_output(), b = plain.make_output();
            for (int i = 0; i < 3; ++i) {
                const VoxelGrid& grid = stream.next(Kind::everywhere);
                fast.encode(grid, a);
                plain.encode(grid, b);
                ASSERT_LE(test::worst(a.values.values(), b.values.values()), kFloatTolerance) << i;
            }
        }
}

/// Two encoders fed with the same frames give the same codes, bit for bit.
void expect_same(Encoder a, Encoder b, const ModelConfig& config, int steps) {
    GridStream stream{config, a.height(), a.width(), 9};
    LatentMap za = a.make_output(), zb = b.make_output();
    for (int i = 0; i < steps; ++i) {
        const VoxelGrid& grid = stream.next();
        a.encode(grid, za);
        b.encode(grid, zb);
        ASSERT_EQ(za.values, zb.values) << "step " << i;
    }
}

TEST(Encoder, LeavingOutQuietTilesChangesNoBit) {
    for (const Case& c : cases())
        for (const test::EngineChoice& choice : test::engine_choices()) {
            if (choice.name == "emulated bf16") continue;  // slow, and the same code around it
            const Model model = test::random_model(c.config, 2);
            EngineOptions all = choice.options;
            all.skip_quiet = false;
            expect_same({model, 150, 131, choice.options}, {model, 150, 131, all}, c.config,
                        choice.options.kernels == Kernels::own ? 15 : 5);
        }
}

TEST(Encoder, SilenceChangesNoBitOfTheCodes) {
    const ModelConfig config = test::small_config();
    for (const Engine engine : {Engine::fast, Engine::plain}) {
        Encoder encoder{test::random_model(config, 4), 61, 45, with(engine)};
        GridStream stream{config, 45, 61, 8};
        LatentMap z = encoder.make_output();
        for (int i = 0; i < 5; ++i) encoder.encode(stream.next(Kind::patch), z);
        const LatentMap before = z;
        for (int i = 0; i < 30; ++i) encoder.encode(stream.next(Kind::silence), z);
        EXPECT_EQ(z.values, before.values);
        encoder.encode(stream.next(Kind::patch), z);
        EXPECT_NE(z.values, before.values) << "an event must be seen";
    }
}

TEST(Encoder, ResetIsTheStateAfterConstruction) {
    for (const Case& c : cases()) {
        const Model model = test::random_model(c.config, 2);
        Encoder used{model, 40, 30, with(Engine::fast)};
        GridStream stream{c.config, 30, 40, 1};
        LatentMap z = used.make_output();
        for (int i = 0; i < 3; ++i) used.encode(stream.next(), z);
        used.reset();
        expect_same(std::move(used), {model, 40, 30, with(Engine::fast)}, c.config, 4);
    }
}

/// Codes follow from the states even where nothing happens: what was seen before is gone at once.
TEST(Encoder, SilenceAfterAResetOrAStateShowsWhatIsRememberedThen) {
    for (const Case& c : cases()) {
        const Model model = test::random_model(c.config, 2);
        Encoder used{model, 70, 50, with(Engine::fast)}, other{model, 70, 50, with(Engine::fast)},
            fresh{model, 70, 50, with(Engine::fast)};
        GridStream stream{c.config, 50, 70, 1};
        LatentMap z = used.make_output(), shown = used.make_output();
        const auto see = [&](Encoder& encoder) {
            for (int i = 0; i < 3; ++i) encoder.encode(stream.next(Kind::patch), z);
        };
        const auto expect_silence_as_of = [&](Encoder& expected) {
            const VoxelGrid& grid = stream.next(Kind::silence);
            used.encode(grid, shown);
            expected.encode(grid, z);
            EXPECT_EQ(shown.values, z.values) << c.name;
        };
        see(used);
        used.encode(stream.next(Kind::patch), shown);
        used.reset();
        expect_silence_as_of(fresh);
        see(used);
        see(other);
        used.encode(stream.next(Kind::patch), shown);
        used.restore(other.state(), "state");
        expect_silence_as_of(other);
    }
}

TEST(Encoder, GoingOnFromASavedStateIsGoingOn) {
    for (const Case& c : cases())
        for (const Engine engine : {Engine::fast, Engine::plain}) {
            const Model model = test::random_model(c.config, 2);
            Encoder first{model, 40, 30, with(engine)};
            GridStream stream{c.config, 30, 40, 1};
            LatentMap z = first.make_output();
            for (int i = 0; i < 5; ++i) first.encode(stream.next(), z);
            Encoder second{model, 40, 30, with(engine)};
            // Through bytes, as a file would.
            second.restore(parse_safetensors(format_safetensors(first.state()), "state"), "state");
            expect_same(std::move(first), std::move(second), c.config, 5);
        }
}

std::string refusal(Encoder& encoder, const TensorFile& state) {
    try {
        encoder.restore(state, "state file");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return "accepted";
}
TEST(Encoder, AStateOfAnotherModelOrSizeIsRefused) {
    const ModelConfig config = test::small_config();
    Encoder encoder{test::random_model(config, 1), 40, 30};
    Encoder other_model{test::random_model(config, 2), 40, 30};
    Encoder other_size{test::random_model(config, 1), 41, 30};
    EXPECT_NE(refusal(encoder, other_model.state()).find("'model'"), std::string::npos);
    EXPECT_NE(refusal(encoder, other_size.state()).find("'width'"), std::string::npos);
    TensorFile cut = encoder.state();
    cut.tensors.erase("h.1");
    EXPECT_NE(refusal(encoder, cut).find("'h.1'"), std::string::npos);
    TensorFile turned = encoder.state();
    turned.tensors.at("h.0").shape = {40, 30, config.widths[0]};
    EXPECT_NE(refusal(encoder, turned).find("'h.0': expected shape [30, 40, "), std::string::npos);
    EXPECT_EQ(refusal(encoder, encoder.state()), "accepted");
}

TEST(Encoder, AModelWhoseShapeCannotBeIsRefused) {
    Model model = test::random_model(test::small_config(), 1);
    model.config.latent_stride = 0;
    EXPECT_THROW(Encoder(model, 16, 16), Error);
}

TEST(Encoder, ImpossibleSizesAreRefused) {
    const Model model = test::random_model(test::small_config(), 1);
    EXPECT_THROW(Encoder(model, 0, 10), Error);
    EXPECT_THROW(Encoder(model, 10, 70000), Error);
}

}  // namespace
}  // namespace eventide
