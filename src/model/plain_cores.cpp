// The plain networks behind the run-time interfaces.
#include "src/model/cores.h"
#include "src/model/encode/plain_encoder.h"
#include "src/model/latent_codes.h"
#include "src/model/render/plain_renderer.h"

#include <algorithm>

namespace eventide {
namespace {

template <typename Network>
class PlainEncoder final : public EncoderCore {
public:
    PlainEncoder(const Model& model, int height, int width) : network_(model, height, width) {}

    std::string description() const override { return "plain, f32"; }
    void step(const VoxelGrid& grid, LatentCodes& latent) noexcept override {
        latent.values = network_.step(grid.values);
        latent.history = {};
    }
    void reset() noexcept override {
        for (Array3<float>& h : network_.states()) std::ranges::fill(h.values(), 0.0F);
    }
    Tensors state() const override {
        Tensors state;
        const auto& maps = network_.states();
        for (std::size_t l = 0; l < maps.size(); ++l)
            state["h." + std::to_string(l)] = {
                {maps[l].height(), maps[l].width(), maps[l].channels()},
                {maps[l].values().begin(), maps[l].values().end()}};
        return state;
    }
    void restore(const Tensors& state) override {
        for (std::size_t l = 0; l < network_.states().size(); ++l)
            std::ranges::copy(state.at("h." + std::to_string(l)).values,
                              network_.states()[l].values().begin());
    }

private:
    Network network_;
};

class PlainRenderer final : public RendererCore {
public:
    explicit PlainRenderer(const Model& model) : network_(model), depth_(model.config.latent) {}

    std::string description() const override { return "plain, f32"; }
    void push(std::int64_t k, const LatentCodes& latent) noexcept override {
        codes_[LatentWindow::slot(k)] = codes_in_float(latent, depth_);
    }
    void reset() noexcept override {}
    void render(const CodeChoice& choice, const FrameGeometry& geometry, SigmaRule rule,
                Array2<float>& intensity, Array2<float>* sigma) noexcept override {
        const auto code = [&](std::int64_t k) { return &codes_[LatentWindow::slot(k)]; };
        // z_{k-2} .. z_{k+2}
        const plain::Codes<float> codes{choice.k > 2 ? code(choice.k - 2) : nullptr,
                                        choice.k > 1 ? code(choice.k - 1) : nullptr, code(choice.k),
                                        choice.next[0] ? code(choice.k + 1) : nullptr,
                                        choice.next[1] ? code(choice.k + 2) : nullptr};
        plain::RenderedFrame<float> out = network_.render(codes, choice.fraction, geometry, rule);
        intensity = std::move(out.intensity);
        if (sigma != nullptr) *sigma = std::move(out.sigma);
    }

private:
    plain::MlpRenderer<float> network_;
    int depth_;
    std::array<Array3<float>, LatentWindow::kLatentsKept> codes_;
};

}  // namespace

std::unique_ptr<EncoderCore> make_plain_encoder(const Model& model, int height, int width) {
    if (model.config.encoder == EncoderKind::gated)
        return std::make_unique<PlainEncoder<plain::GatedEncoder<float>>>(model, height, width);
    return std::make_unique<PlainEncoder<plain::ThesisEncoder<float>>>(model, height, width);
}

std::unique_ptr<RendererCore> make_plain_renderer(const Model& model) {
    return std::make_unique<PlainRenderer>(model);
}

}  // namespace eventide
