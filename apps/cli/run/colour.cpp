// Colour cameras.
#include "apps/cli/run/colour.h"

#include "apps/cli/settings/time_point.h"
#include "drivers/simulated/simulated_name.h"
#include "replay/formats.h"
#include "src/core/error.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>

namespace eventide::app {

namespace {

void check_colour(const RunSettings& settings, const SensorInfo& sensor, ColourFilter filter) {
    const auto refuse = [](const std::string& what) {
        throw Error(ErrorKind::usage, "--colour: " + what);
    };
    if (filter == ColourFilter::none)
        refuse(
            "expected a camera or recording that tells its colour filter, or --bayer rggb, "
            "grbg, gbrg or bggr; found neither in " +
            settings.source);
    if (sensor.width % 2 != 0 || sensor.height % 2 != 0)
        refuse("expected a sensor with even sides, found " +
               show_size({sensor.width, sensor.height}));
}

}  // namespace

ColourFilter filter_of_images(const std::string& source, std::string_view format,
                              const OpenOptions& options) {
    constexpr std::uint64_t kMaxBytes = 256 << 20;
    constexpr std::string_view kEachImageTells[]{"aedat3", "rosbag", "mcap", "db3"};
    if (std::ranges::find(kEachImageTells, format) == std::end(kEachImageTells) ||
        is_read_once(source))
        return ColourFilter::none;
    const auto recording = open_recording(source, options);
    const auto parser = recording->make_parser();
    RawPacket packet;
    Batch batch;
    for (std::uint64_t bytes = 0; bytes < kMaxBytes; bytes += packet.bytes.size()) {
        if (recording->read(packet) == ReadStatus::end) break;
        batch.clear();
        parser->parse(packet.bytes, batch);
        for (const ReferenceImage& image : batch.images)
            if (image.filter != ColourFilter::none) return image.filter;
        if (!batch.images.empty()) break;
    }
    return ColourFilter::none;
}

ColourFilter source_colours_of(const RunSettings& settings, const SensorInfo& source, bool live) {
    if (settings.bayer) return *settings.bayer;
    // Else each image is taken at its word (demosaiced()), and nothing is read twice.
    const bool needed = settings.colour || !settings.filter.empty() ||
                        !settings.events_out.empty() || !settings.record.empty();
    if (!needed || source.colour_filter != ColourFilter::none || live ||
        names_simulation(settings.source))
        return source.colour_filter;
    return filter_of_images(settings.source, source.format, settings.input.options());
}

ColourFilter colour_filter_of(const RunSettings& settings, ColourFilter source,
                              const SensorInfo& sensor, const FilterChain& filters) {
    const ColourFilter filter = filters.pattern(source);
    if (filter == ColourFilter::none && source != ColourFilter::none)
        for (const std::string& text : settings.filter)
            if (text.starts_with("subsample:"))
                throw Error(ErrorKind::usage,
                            "--filter " + text + ": leaves no square of colours of the " +
                                std::string{name_of(source)} +
                                " sensor whole; expected odd steps, such as subsample:3x3, or "
                                "--bayer none");
    if (settings.colour) check_colour(settings, sensor, filter);
    return filter;
}

ColourNetworks::ColourNetworks(Network& network, const SensorInfo& sensor, ColourFilter filter,
                               const RenderRequest& request, const ImagesOnTheWay* images,
                               EncodeStage& encode, RenderStage& render)
    : filter_{filter} {
    SensorInfo half = sensor;
    half.width /= 2;
    half.height /= 2;
    RenderRequest own = request;  // of all the pixels of a colour
    own.width = half.width;
    own.height = half.height;
    own.region = {};
    own.want_sigma = images != nullptr && request.want_sigma;
    std::array<EncodeStage*, 3> encoders{};
    std::array<RenderStage*, 3> renderers{};
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        Channel& channel = channels_[c];
        channel.encoder.emplace(network.make_encoder(half));
        channel.renderer.emplace(network.make_renderer(half));
        if (images != nullptr) channel.images.keep_at_most(images->most());
        if (images != nullptr)
            channel.render.emplace(*channel.renderer, own, half.width, half.height, channel.images);
        else
            channel.render.emplace(*channel.renderer, own);
        encoders[c] = &*channel.encoder;
        renderers[c] = &*channel.render;
    }
    encode_.emplace(encode, encoders, filter, sensor.width, sensor.height, network.config().bins);
    const ColourRenderStage::View view{request.width, request.height, request.region.x,
                                       request.region.y};
    render_.emplace(render, renderers, filter, sensor.width, sensor.height, view,
                    encode_->make_output());
}

void ColourNetworks::see(const std::vector<ReferenceImage>& images) {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        // One for each, as they are counted.
        std::vector<ReferenceImage> parts(images.size());
        for (std::size_t i = 0; i < images.size(); ++i) {
            const BayerSite site = site_of(filter_, kColourChannels[c]);
            if (auto part = image_of_site(images[i], site, kColourChannels[c]))
                parts[i] = std::move(*part);
            else
                parts[i].t = images[i].t;
        }
        channels_[c].images.put(std::move(parts));
    }
}

}  // namespace eventide::app
