// What stands behind Encoder and Renderer: one class per engine.
#pragma once

#include "src/model/engine.h"
#include "src/model/latent_window.h"
#include "src/model/model_file.h"
#include "src/model/render/sampling.h"

#include <memory>
#include <string>

namespace eventide {

/// step() advances the state by one event window; latent.values has the size that
/// Encoder::make_output() gave, and may hold codes of any step before.
class EncoderCore {
public:
    virtual ~EncoderCore() = default;
    virtual std::string description() const = 0;
    /// What latent.is_bf16 has to be.
    virtual bool gives_bf16() const { return false; }
    /// Writes latent.values and says in latent.history what is known of it.
    virtual void step(const VoxelGrid& grid, LatentCodes& latent) noexcept = 0;
    virtual void reset() noexcept = 0;
    /// The hidden maps by name, [height, width, channels].
    virtual Tensors state() const = 0;
    /// `state` has the names and shapes that state() gives.
    virtual void restore(const Tensors& state) = 0;
};

std::unique_ptr<EncoderCore> make_plain_encoder(const Model& model, int height, int width);
std::unique_ptr<EncoderCore> make_fast_encoder(const Model& model, int height, int width,
                                               const EngineOptions& options);

/// Which codes a frame reads, and where in time it lies.
struct CodeChoice {
    std::int64_t k = 0;   ///< event window the time lies in
    double fraction = 0;  ///< within it
    bool next[2] = {};    ///< whether z_{k+1} and z_{k+2} are known
};

/// push() of k = 1, 2, ... since construction or reset(); a frame reads z_{k-2} to z_{k+2} of those
/// still kept (LatentWindow). Maps are copied. One thread at a time, as of EncoderCore.
class RendererCore {
public:
    virtual ~RendererCore() = default;
    virtual std::string description() const = 0;
    /// Takes the memory that rendering such frames needs; until then render() takes it.
    virtual void make_room(const FrameGeometry&) {}
    virtual void push(std::int64_t k, const LatentCodes& latent) noexcept = 0;
    /// The same; may keep the codes themselves, and leave others of the same size with a history
    /// that is true of them.
    virtual void take(std::int64_t k, LatentCodes& latent) noexcept { push(k, latent); }
    virtual void reset() noexcept = 0;
    /// `sigma` is null where not asked for.
    virtual void render(const CodeChoice& codes, const FrameGeometry& geometry, SigmaRule rule,
                        Array2<float>& intensity, Array2<float>* sigma) noexcept = 0;
    /// Since construction; a copied pixel does not count.
    virtual std::uint64_t pixels_rendered() const { return 0; }
};

std::unique_ptr<RendererCore> make_plain_renderer(const Model& model);
std::unique_ptr<RendererCore> make_fast_renderer(const Model& model, int sensor_width,
                                                 int sensor_height, const EngineOptions& options);

}  // namespace eventide
