// Does the network stay sound for as long as a camera may run? Drives the encoder of a model for
// any number of event windows of simulated scenes with pauses and bursts, and says at intervals:
//   NaN        numbers that are none, in states and codes, since the beginning
//   max|h|     the largest state now; rms h: their root mean square
//   double     codes of the fast engine against double precision over `segment` steps, both begun
//              from the fast engine's state: relative RMS, per cent
//   begun anew codes against those of a network that began only `memory` steps ago: relative RMS,
//              per cent. What stays is what the scene's distant past still says; it must not grow
// Fails where there is a NaN, a recurrent state leaves [-1, 1], or double is further off than it
// may be. `stability --help` lists the options.
#include "src/binning/binner.h"
#include "src/model/encode/encoder.h"
#include "src/model/encode/plain_encoder.h"
#include "src/model/latent_codes.h"
#include "src/simulate/presets.h"
#include "src/simulate/scene/textures.h"
#include "src/simulate/simulated_stream.h"
#include "tests/model/streams.h"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <optional>

namespace eventide {
namespace {

struct Options {
    std::string model = EVENTIDE_SOURCE_DIR "/config/models/default.safetensors";
    std::string precision = "auto";
    int width = 64, height = 48;
    long steps = 200'000, interval = 10'000;
    int segment = 20, memory = 400;
    std::uint32_t seed = 1;
};

/// Event windows of 50 ms out of one simulated scene after the other, with pauses of up to 10 s now
/// and then, and frames in which every pixel fires many times.
class Scenes {
public:
    Scenes(const Options& options, int bins)
        : options_(options),
          random_(options.seed),
          binner_{bins, options.height, options.width},
          grid_(binner_.make_output()) {}

    const VoxelGrid& next() {
        if (left_-- == 0) begin_scene();
        const Window window{end_, end_ + SensorDuration{50'000}};
        end_ = window.end;
        events_.clear();
        if (pause_ > 0) {
            --pause_;
        } else {
            const auto dice = random_() % 1000;
            if (dice < 4) pause_ = int(random_() % 200);
            film_now_ += SensorDuration{50'000};
            stream_->advance(film_now_, events_);
            for (Event& event : events_) event.t += window.end - film_now_;
            if (dice >= 990) burst(window);
        }
        binner_.process({.window = window, .events = events_}, grid_);
        return grid_;
    }

private:
    void begin_scene() {
        left_ = 400 + int(random_() % 400);
        const SimulationPreset& preset = simulation_preset("wide");
        stream_.emplace(preset.scene, preset.sensor, textures_, options_.width, options_.height,
                        random_());
        film_now_ = stream_->now();
    }
    /// Up to fifty events at every pixel, of either polarity.
    void burst(const Window& window) {
        const int most = 1 + int(random_() % 50);
        for (int y = 0; y < options_.height; ++y)
            for (int x = 0; x < options_.width; ++x)
                for (auto n = random_() % unsigned(most); n > 0; --n)
                    events_.push_back({window.begin + SensorDuration{1 + random_() % 50'000},
                                       std::uint16_t(x), std::uint16_t(y),
                                       random_() % 2 == 0 ? Polarity::on : Polarity::off});
    }

    Options options_;
    std::mt19937 random_;
    std::shared_ptr<const TextureLibrary> textures_ = procedural_textures(40);
    std::optional<SimulatedStream> stream_;
    Binner binner_;
    VoxelGrid grid_;
    std::vector<Event> events_;
    SensorTime end_{}, film_now_{};
    int left_ = 0, pause_ = 0;
};

/// Relative root mean square of a difference.
struct Share {
    double squares = 0, power = 0;
    template <typename A, typename B>
    void add(const A& a, const B& reference) {
        for (std::size_t i = 0; i < reference.size(); ++i) {
            squares += std::pow(double(a[i]) - double(reference[i]), 2);
            power += std::pow(double(reference[i]), 2);
        }
    }
    double percent() const { return power == 0 ? 0 : 100 * std::sqrt(squares / power); }
};

class Stability {
public:
    Stability(const Options& options, const Model& model, const EngineOptions& engine)
        : options_(options),
          model_(model),
          engine_(engine),
          scenes_(options, model.config.bins),
          encoder_{model, options.width, options.height, engine},
          latent_(encoder_.make_output()) {}

    /// True where all is well.
    bool run() {
        std::printf("%s, %dx%d, %s\n", options_.model.c_str(), options_.width, options_.height,
                    encoder_.description().c_str());
        std::printf("%10s %12s %5s %8s %8s %8s %12s %12s\n", "step", "events", "NaN", "max|h|",
                    "rms h", "max|z|", "double, %", "begun anew, %");
        for (long done = 0; done < options_.steps;) {
            const long until = std::min(done + options_.interval, options_.steps);
            done = advance(done, until);
            report(done);
        }
        std::printf("%s\n", sound_ ? "sound" : "NOT sound");
        return sound_;
    }

private:
    /// The last steps of an interval are also walked by a network begun anew, and the very last by
    /// double precision.
    long advance(long done, long until) {
        std::optional<Encoder> anew;
        std::optional<plain::GatedEncoder<double>> gated;
        std::optional<plain::ThesisEncoder<double>> thesis;
        against_double_ = against_anew_ = {};
        LatentMap fresh;
        for (; done < until; ++done) {
            const long left = until - done;
            if (left == options_.memory) {
                anew.emplace(model_, options_.width, options_.height, engine_);
                fresh = anew->make_output();
            }
            if (left == options_.segment) {
                if (model_.config.encoder == EncoderKind::gated)
                    begin_from_here(gated);
                else
                    begin_from_here(thesis);
            }
            const VoxelGrid& grid = scenes_.next();
            encoder_.encode(grid, latent_);
            events_ += grid.events;
            const Array3<float> codes = codes_in_float(latent_, model_.config.latent);
            const auto z = codes.values();
            for (const float code : z) {
                nans_ += std::isfinite(code) ? 0 : 1;
                most_z_ = std::max(most_z_, std::abs(double(code)));
            }
            if (anew) anew->encode(grid, fresh);
            if (gated) against_double_.add(z, gated->step(test::as<double>(grid.values)).values());
            if (thesis)
                against_double_.add(z, thesis->step(test::as<double>(grid.values)).values());
            if (anew && left <= options_.segment)
                against_anew_.add(codes_in_float(fresh, model_.config.latent).values(), z);
        }
        return done;
    }
    template <typename Network>
    void begin_from_here(std::optional<Network>& network) {
        network.emplace(model_, options_.height, options_.width);
        const TensorFile state = encoder_.state();
        for (std::size_t l = 0; l < network->states().size(); ++l)
            std::ranges::copy(state.tensors.at("h." + std::to_string(l)).values,
                              network->states()[l].values().begin());
    }
    void report(long done) {
        double most = 0, squares = 0;
        std::size_t count = 0;
        bool bounded = true;
        const TensorFile state = encoder_.state();
        for (std::size_t l = 0; l < model_.config.recurrent.size(); ++l) {
            const auto found = state.tensors.find("h." + std::to_string(l));
            if (found == state.tensors.end()) continue;
            for (const float h : found->second.values) {
                nans_ += std::isfinite(h) ? 0 : 1;
                most = std::max(most, std::abs(double(h)));
                squares += double(h) * h;
                bounded &= model_.config.recurrent[l] == 0 || std::abs(h) <= 1;
            }
            count += found->second.values.size();
        }
        const bool narrow = encoder_.description().find("bf16") != std::string::npos;
        const double allowed = narrow ? 2 : 0.02;  // per cent
        sound_ &= nans_ == 0 && bounded && against_double_.percent() <= allowed;
        std::printf("%10ld %12.0f %5ld %8.4f %8.4f %8.3f %12.2g %12.2g\n", done, double(events_),
                    nans_, most, std::sqrt(squares / double(count)), most_z_,
                    against_double_.percent(), against_anew_.percent());
        std::fflush(stdout);
        most_z_ = 0;
    }

    Options options_;
    const Model& model_;
    EngineOptions engine_;
    Scenes scenes_;
    Encoder encoder_;
    LatentMap latent_;
    Share against_double_, against_anew_;
    std::uint64_t events_ = 0;
    long nans_ = 0;
    double most_z_ = 0;
    bool sound_ = true;
};

int main_of(int argc, char** argv) {
    Options options;
    CLI::App app{"Numerical stability of a model's encoder over a long run of simulated scenes"};
    app.add_option("--model", options.model, "safetensors file")->capture_default_str();
    app.add_option("--steps", options.steps, "event windows of 50 ms")->capture_default_str();
    app.add_option("--interval", options.interval, "steps between two lines")
        ->capture_default_str();
    app.add_option("--segment", options.segment, "steps in double precision per line")
        ->capture_default_str();
    app.add_option("--memory", options.memory, "steps of the network begun anew")
        ->capture_default_str();
    app.add_option("--width", options.width, "px")->capture_default_str();
    app.add_option("--height", options.height, "px")->capture_default_str();
    app.add_option("--seed", options.seed)->capture_default_str();
    app.add_option("--precision", options.precision, "auto, f32, bf16 or bf16_emulated")
        ->capture_default_str()
        ->check(CLI::IsMember({"auto", "f32", "bf16", "bf16_emulated"}));
    CLI11_PARSE(app, argc, argv);
    EngineOptions engine;
    for (const auto& [name, precision] :
         {std::pair{"auto", Precision::automatic}, std::pair{"f32", Precision::f32},
          std::pair{"bf16", Precision::bf16}})
        if (options.precision == name) engine.precision = precision;
    engine.emulate_bf16 = options.precision == "bf16_emulated";
    const Model model = load_model(options.model);
    return Stability{options, model, engine}.run() ? 0 : 1;
}

}  // namespace
}  // namespace eventide

int main(int argc, char** argv) {
    try {
        return eventide::main_of(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "stability: %s\n", error.what());
        return 2;
    }
}
