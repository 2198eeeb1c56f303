// Encoder and renderer together, every back end, against double precision: over a long run, at real
// sizes, and with the shipped network.
#include "src/model/encode/encoder.h"
#include "src/model/encode/plain_encoder.h"
#include "src/model/latent_codes.h"
#include "src/model/render/plain_renderer.h"
#include "src/model/render/renderer.h"
#include "tests/model/engine_choices.h"
#include "tests/model/streams.h"
#include "tests/model/threads.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <deque>
#include <filesystem>

namespace eventide {
namespace {

/// Float32 against double: sums of a few hundred products, each rounded to 6e-8, in numbers near 1;
/// gates keep it from growing.
constexpr double kFloatTolerance = 2e-4;
/// bf16 keeps 8 bits of each factor; root mean square over all codes and frames of a run.
constexpr double kBf16Share = 0.02;

/// How far something is from double precision.
struct Distance {
    double most = 0, squares = 0, power = 0;

    template <typename A, typename B>
    void add(const A& fast, const B& exact) {
        most = std::max(most, test::worst(fast, exact));
        for (std::size_t i = 0; i < exact.size(); ++i) {
            squares += std::pow(double(fast[i]) - exact[i], 2);
            power += exact[i] * exact[i];
        }
    }
    double share() const { return std::sqrt(squares / power); }
};

/// The network in double precision: codes of the newest event windows, and frames of them.
template <typename Network>
class Exact {
public:
    Exact(const Model& model, int height, int width)
        : encoder_{model, height, width}, renderer_{model}, config_(model.config) {
        picture_.sensor_height = picture_.height = picture_.part_height = height;
        picture_.sensor_width = picture_.width = picture_.part_width = width;
    }
    const Array3<double>& step(const VoxelGrid& grid) {
        codes_.push_back(encoder_.step(test::as<double>(grid.values)));
        if (codes_.size() > 3) codes_.pop_front();
        return codes_.back();
    }
    /// Of the newest event window, at the live edge.
    plain::RenderedFrame<double> render(double fraction) const {
        const auto ago = [&](std::size_t n) {
            return codes_.size() > n ? &codes_[codes_.size() - 1 - n] : nullptr;
        };
        return renderer_.render({ago(2), ago(1), ago(0), nullptr, nullptr}, fraction, picture_,
                                config_.sigma_rule);
    }

private:
    Network encoder_;
    plain::MlpRenderer<double> renderer_;
    ModelConfig config_;
    FrameGeometry picture_;
    std::deque<Array3<double>> codes_;
};

struct Run {
    std::string name;
    bool bf16 = false;
    Encoder encoder;
    Renderer renderer;
    LatentMap latent;
    Frame frame;
    Distance codes, frames;

    Run(std::string text, bool narrow, const Model& model, int height, int width,
        const EngineOptions& options)
        : name(std::move(text)),
          bf16(narrow),
          encoder{model, width, height, options},
          renderer{model, width, height, options},
          latent(encoder.make_output()),
          frame(renderer.make_output({})) {}
};

/// All back ends and the plain engine over the same frames; every n-th is rendered, too.
template <typename Network>
void compare(const Model& model, int height, int width, int steps, int render_every,
             bool plain_too = true) {
    Exact<Network> exact{model, height, width};
    std::vector<Run> runs;
    for (const test::EngineChoice& choice : test::engine_choices())
        runs.emplace_back(choice.name, choice.bf16, model, height, width, choice.options);
    if (plain_too)
        runs.emplace_back("plain f32", false, model, height, width,
                          EngineOptions{.engine = Engine::plain});
    test::GridStream stream{model.config, height, width, 5};
    for (int k = 1; k <= steps; ++k) {
        const VoxelGrid& grid = stream.next();
        const Array3<double>& z = exact.step(grid);
        RenderRequest request;
        request.t = grid.window.begin + SensorDuration{30'000};
        const bool shown = k % render_every == 0;
        const plain::RenderedFrame<double> geometry =
            shown ? exact.render(0.6) : plain::RenderedFrame<double>{};
        for (Run& run : runs) {
            run.encoder.encode(grid, run.latent);
            run.renderer.push(run.latent);
            run.codes.add(codes_in_float(run.latent, model.config.latent).values(), z.values());
            if (!shown) continue;
            run.renderer.render(request, run.frame);
            run.frames.add(run.frame.intensity.values(), geometry.intensity.values());
            run.frames.add(run.frame.sigma.values(), geometry.sigma.values());
        }
    }
    for (const Run& run : runs) {
        std::printf("  %-14s codes: worst %.2g, rms %.2g %%; frames: worst %.2g, rms %.2g %%\n",
                    run.name.c_str(), run.codes.most, 100 * run.codes.share(), run.frames.most,
                    100 * run.frames.share());
        EXPECT_LE(run.codes.share(), run.bf16 ? kBf16Share : kFloatTolerance) << run.name;
        EXPECT_LE(run.frames.share(), run.bf16 ? kBf16Share : kFloatTolerance) << run.name;
        if (run.bf16) continue;
        EXPECT_LE(run.codes.most, kFloatTolerance) << run.name;
        EXPECT_LE(run.frames.most, kFloatTolerance) << run.name;
    }
}

/// 200; fewer under sanitizers (which bring their own malloc), where each step takes twenty times
/// as long.
int long_run() {
    return test::can_count_allocations() ? 200 : 25;
}

using Gated = plain::GatedEncoder<double>;
using Thesis = plain::ThesisEncoder<double>;

TEST(WholeModel, EveryShippedNetworkStaysWithDoubleOver200Steps) {
    int shipped = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator{EVENTIDE_SOURCE_DIR "/config/models"}) {
        if (entry.path().extension() != ".safetensors") continue;
        SCOPED_TRACE(entry.path().filename());
        const Model model = load_model(entry.path());
        if (model.config.encoder == EncoderKind::gated)
            compare<Gated>(model, 19, 21, long_run(), 25);
        else
            compare<Thesis>(model, 19, 21, long_run(), 25);
        ++shipped;
    }
    EXPECT_GE(shipped, 1);
}
TEST(WholeModel, AnUntrainedThesisNetworkStaysWithDoubleOver200Steps) {
    compare<Thesis>(test::random_model(test::thesis_config(), 11), 9, 11, long_run(), 25);
}
TEST(WholeModel, ManyTilesOfOddSizesStayWithDouble) {
    compare<Gated>(test::random_model(test::small_config(), 3), 260, 346, 3, 3, false);
}
TEST(WholeModel, TheShippedNetworkStaysWithDoubleOverManyTiles) {
    const std::filesystem::path file{EVENTIDE_SOURCE_DIR "/config/models/default.safetensors"};
    compare<Gated>(load_model(file), 71, 97, 5, 5, false);
}

/// The bits of codes and frames after some steps.
struct Bits {
    std::vector<Array3<float>> codes;
    std::vector<Array2<float>> frames;
    friend bool operator==(const Bits&, const Bits&) = default;
};
Bits bits_of(const Model& model, int height, int width, const EngineOptions& options) {
    Encoder encoder{model, width, height, options};
    Renderer renderer{model, width, height, options};
    test::GridStream stream{model.config, height, width, 9};
    LatentMap latent = encoder.make_output();
    Bits bits;
    for (int k = 0; k < 5; ++k) {
        const VoxelGrid& grid = stream.next();
        encoder.encode(grid, latent);
        renderer.push(latent);
        RenderRequest request;
        request.t = grid.window.end;
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        bits.codes.push_back(latent.values);
        bits.frames.push_back(frame.intensity);
        bits.frames.push_back(frame.sigma);
    }
    return bits;
}

TEST(WholeModel, TheNumberOfThreadsChangesNoBit) {
    ModelConfig half = test::small_config();
    half.latent_stride = 2;
    ModelConfig light = test::small_config();
    light.reset_gate = light.out_layer = false;
    light.latent = light.widths[0];
    for (const ModelConfig& config : {test::small_config(), half, light, test::thesis_config()}) {
        const Model model = test::random_model(config, 1);
        for (test::EngineChoice& choice : test::engine_choices()) {
            const Bits alone = bits_of(model, 61, 75, choice.options);
            for (const int threads : {2, 3}) {
                choice.options.parallel_for = test::with_threads(threads);
                EXPECT_EQ(bits_of(model, 61, 75, choice.options), alone)
                    << choice.name << ", " << threads << " threads";
            }
        }
    }
}

TEST(WholeModel, ADifferentBackendIsNoticed) {
    if (!onednn_available()) GTEST_SKIP() << "built without oneDNN";
    const Model model = test::random_model(test::small_config(), 1);
    EngineOptions own, onednn;
    own.precision = onednn.precision = Precision::f32;
    own.kernels = Kernels::own;
    onednn.kernels = Kernels::onednn;
    EXPECT_NE(Encoder(model, 20, 20, own).description(),
              Encoder(model, 20, 20, onednn).description());
    own.emulate_bf16 = true;
    EXPECT_NE(bits_of(model, 20, 20, own), bits_of(model, 20, 20, onednn));
}

}  // namespace
}  // namespace eventide
