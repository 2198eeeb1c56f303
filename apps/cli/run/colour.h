// Colour cameras: the filter before their pixels, their images, and networks for single colours.
#pragma once

#include "apps/cli/run/loaded_model.h"
#include "apps/cli/settings/run_settings.h"
#include "pipeline/colour_stages.h"
#include "pipeline/filters/filter_chain.h"
#include "pipeline/model_render_stage.h"
#include "src/model/encode/encoder.h"

#include <eventide/event.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eventide::app {

/// The colour filter that the first images of a recording tell, in a format in which each image
/// does (AEDAT 3, bags); reads as far as that. None also where they tell none, where there are none
/// in the first 256 MiB, and of what can be read but once.
ColourFilter filter_of_images(const std::string& source, std::string_view format,
                              const OpenOptions& options);

/// --bayer, else what the camera, recording or its images say: of the source, before all filters of
/// events. None, too, where nobody needs to know beforehand.
ColourFilter source_colours_of(const RunSettings& settings, const SensorInfo& source, bool live);

/// The same behind the filters. Throws Error (usage) where those leave no such pattern, where
/// --colour finds no colours, or contradicts something else that was asked for. `source` is before
/// the filters, `sensor` behind them.
ColourFilter colour_filter_of(const RunSettings& settings, ColourFilter source,
                              const SensorInfo& sensor, const FilterChain& filters);

/// What --colour adds to the stages for all pixels.
class ColourNetworks {
public:
    /// The camera's images correct each colour's frames where `images` are taken; no more than of
    /// those are on their way.
    ColourNetworks(Network& network, const SensorInfo& sensor, ColourFilter filter,
                   const RenderRequest& request, const ImagesOnTheWay* images, EncodeStage& encode,
                   RenderStage& render);

    EncodeStage& encode() { return *encode_; }
    RenderStage& render() { return *render_; }
    ColourFilter filter() const { return filter_; }
    Encoder& encoder(ColourChannel channel) { return *channels_[std::size_t(channel)].encoder; }
    const Encoder& encoder(ColourChannel channel) const {
        return *channels_[std::size_t(channel)].encoder;
    }
    /// Bin thread. Mosaics or colours.
    void see(const std::vector<ReferenceImage>& images);

private:
    struct Channel {
        std::optional<Encoder> encoder;
        std::optional<Renderer> renderer;
        std::optional<ModelRenderStage> render;
        ImagesOnTheWay images;
    };
    ColourFilter filter_;
    std::array<Channel, 3> channels_;
    std::optional<ColourEncodeStage> encode_;
    std::optional<ColourRenderStage> render_;
};

}  // namespace eventide::app
