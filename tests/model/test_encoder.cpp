// The encoder: fast against plain against double, and what must not change anything.
#include "src/core/error.h"
#include "src/model/encoder.h"
#include "src/model/plain_encoder.h"
#include "src/nn/packed_layers.h"
#include "tests/model/streams.h"

#include <gtest/gtest.h>

#include <thread>

namespace eventide {
namespace {

using test::GridStream;
using Kind = GridStream::Kind;

/// Float32 against double over a recurrent run; states are near 1 and a step adds sums of a few
/// hundred products, each rounded to 6e-8, which gates keep from growing.
constexpr double kFloatTolerance = 2e-4;
/// bf16 keeps 8 bits of each factor: 2^-9 relative per product, averaged over the sums.
constexpr double kBf16Tolerance = 0.25;

ParallelFor three_threads() {
    return [](int n, const std::function<void(int)>& body) {
        std::atomic<int> next{0};
        const auto work = [&] {
            for (int i = next++; i < n; i = next++) body(i);
        };
        std::thread a{work}, b{work};
        work();
        a.join();
        b.join();
    };
}

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
    return {{"small", test::small_config()},
            {"half", half},
            {"single level", single},
            {"default", ModelConfig{}},
            {"thesis", test::thesis_config()}};
}

TEST(Encoder, FastAgreesWithPlainAtEveryShape) {
    for (const Case& c : cases())
        for (const auto& [height, width] : shapes()) {
            const Model model = random_model(c.config, 7);
            Encoder fast{model, width, height, with(Engine::fast)};
            Encoder plain{model, width, height, with(Engine::plain)};
            GridStream stream{c.config, height, width, 3};
            LatentMap a = fast.make_output(), b = plain.make_output();
            for (int i = 0; i < 4; ++i) {
                const VoxelGrid& grid = stream.next();
                fast.encode(grid, a);
                plain.encode(grid, b);
                ASSERT_LE(test::worst(a.values.values(), b.values.values()), kFloatTolerance)
                    << c.name << " " << width << "x" << height << " step " << i;
            }
        }
}

template <typename Network>
void compare_long(const ModelConfig& config, int steps) {
    const int kHeight = config.encoder == EncoderKind::thesis ? 9 : 26;
    const int kWidth = config.encoder == EncoderKind::thesis ? 11 : 35;
    const Model model = random_model(config, 11);
    Network reference{model, kHeight, kWidth};
    Encoder fast{model, kWidth, kHeight, with(Engine::fast)};
    Encoder plain{model, kWidth, kHeight, with(Engine::plain)};
    GridStream stream{config, kHeight, kWidth, 5};
    LatentMap a = fast.make_output(), b = plain.make_output();
    double fast_worst = 0, plain_worst = 0;
    for (int i = 0; i < steps; ++i) {
        const VoxelGrid& grid = stream.next();
        fast.encode(grid, a);
        plain.encode(grid, b);
        const Array3<double> z = reference.step(test::as<double>(grid.values));
        fast_worst = std::max(fast_worst, test::worst(a.values.values(), z.values()));
        plain_worst = std::max(plain_worst, test::worst(b.values.values(), z.values()));
    }
    EXPECT_LE(fast_worst, kFloatTolerance);
    EXPECT_LE(plain_worst, kFloatTolerance);
    std::printf("  worst over %d steps: fast %.2g, plain %.2g\n", steps, fast_worst, plain_worst);
}
TEST(Encoder, GatedStaysWithDoubleOver200StepsOfPausesAndBursts) {
    compare_long<plain::GatedEncoder<double>>(test::small_config(), 200);
}
TEST(Encoder, ThesisStaysWithDoubleOver200StepsOfPausesAndBursts) {
    compare_long<plain::ThesisEncoder<double>>(test::thesis_config(), 200);
}

TEST(Encoder, Bf16StaysNearDoubleOver200Steps) {
    if (!bf16_available()) GTEST_SKIP() << "this processor has no bf16 products";
    const ModelConfig config = test::small_config();
    const Model model = random_model(config, 11);
    plain::GatedEncoder<double> reference{model, 26, 35};
    Encoder fast{model, 35, 26, with(Engine::fast, Precision::bf16)};
    GridStream stream{config, 26, 35, 5};
    LatentMap a = fast.make_output();
    double most = 0, squares = 0, power = 0;
    for (int i = 0; i < 200; ++i) {
        const VoxelGrid& grid = stream.next();
        fast.encode(grid, a);
        const Array3<double> z = reference.step(test::as<double>(grid.values));
        most = std::max(most, test::worst(a.values.values(), z.values()));
        for (std::size_t n = 0; n < z.values().size(); ++n) {
            const double d = a.values.values()[n] - z.values()[n];
            squares += d * d;
            power += z.values()[n] * z.values()[n];
        }
    }
    EXPECT_LE(most, kBf16Tolerance);
    std::printf("  worst %.2g, relative rms %.2g\n", most, std::sqrt(squares / power));
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

TEST(Encoder, ThreadsChangeNoBit) {
    for (const Case& c : cases())
        for (const Precision precision : {Precision::f32, Precision::automatic}) {
            const Model model = random_model(c.config, 1);
            EngineOptions many = with(Engine::fast, precision);
            many.parallel_for = three_threads();
            expect_same({model, 75, 61, with(Engine::fast, precision)}, {model, 75, 61, many},
                        c.config, 10);
        }
}

TEST(Encoder, LeavingOutQuietTilesChangesNoBit) {
    for (const Case& c : cases())
        for (const Precision precision : {Precision::f32, Precision::automatic}) {
            const Model model = random_model(c.config, 2);
            EngineOptions all = with(Engine::fast, precision);
            all.skip_quiet = false;
            expect_same({model, 150, 131, with(Engine::fast, precision)}, {model, 150, 131, all},
                        c.config, 15);
        }
}

TEST(Encoder, SilenceChangesNoBitOfTheCodes) {
    const ModelConfig config = test::small_config();
    for (const Engine engine : {Engine::fast, Engine::plain}) {
        Encoder encoder{random_model(config, 4), 61, 45, with(engine)};
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
        const Model model = random_model(c.config, 2);
        Encoder used{model, 40, 30, with(Engine::fast)};
        GridStream stream{c.config, 30, 40, 1};
        LatentMap z = used.make_output();
        for (int i = 0; i < 3; ++i) used.encode(stream.next(), z);
        used.reset();
        expect_same(std::move(used), {model, 40, 30, with(Engine::fast)}, c.config, 4);
    }
}

TEST(Encoder, GoingOnFromASavedStateIsGoingOn) {
    for (const Case& c : cases())
        for (const Engine engine : {Engine::fast, Engine::plain}) {
            const Model model = random_model(c.config, 2);
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
    Encoder encoder{random_model(config, 1), 40, 30};
    Encoder other_model{random_model(config, 2), 40, 30};
    Encoder other_size{random_model(config, 1), 41, 30};
    EXPECT_NE(refusal(encoder, other_model.state()).find("'model'"), std::string::npos);
    EXPECT_NE(refusal(encoder, other_size.state()).find("'width'"), std::string::npos);
    TensorFile cut = encoder.state();
    cut.tensors.erase("h.1");
    EXPECT_NE(refusal(encoder, cut).find("'h.1'"), std::string::npos);
    EXPECT_EQ(refusal(encoder, encoder.state()), "accepted");
}

TEST(Encoder, ImpossibleSizesAreRefused) {
    const Model model = random_model(test::small_config(), 1);
    EXPECT_THROW(Encoder(model, 0, 10), Error);
    EXPECT_THROW(Encoder(model, 10, 70000), Error);
}

}  // namespace
}  // namespace eventide
