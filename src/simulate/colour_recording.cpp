// A simulated colour camera.
#include "src/simulate/colour_recording.h"

#include <algorithm>

namespace eventide {

namespace {

void take_images(const std::vector<ReferenceImage>& seen, ColourFilter filter,
                 ColourChannel channel, std::vector<ReferenceImage>& mosaics) {
    if (mosaics.empty()) {
        mosaics = seen;
        for (ReferenceImage& mosaic : mosaics) mosaic.filter = filter;
    }
    for (std::size_t i = 0; i < seen.size(); ++i)
        for (int y = 0; y < seen[i].pixels.height(); ++y)
            for (int x = 0; x < seen[i].pixels.width(); ++x)
                if (channel_at(filter, x, y) == channel)
                    mosaics[i].pixels(y, x) = seen[i].pixels(y, x);
}

}  // namespace

ColourRecording::ColourRecording(const SimRecordingSettings& settings, const Textures& textures,
                                 ColourFilter filter)
    : filter_(filter) {
    for (const auto& library : textures) colours_.emplace_back(settings, library);
}

bool ColourRecording::next(Batch& batch, Truths& truths) {
    batch.clear();
    Batch part;
    for (std::size_t c = 0; c < colours_.size(); ++c) {
        if (!colours_[c].next(part, truths[c])) return false;
        take_events(part, ColourChannel(c), batch);
        take_images(part.images, filter_, ColourChannel(c), batch.images);
    }
    return true;
}

void ColourRecording::take_events(const Batch& part, ColourChannel channel, Batch& batch) {
    const auto before = std::ptrdiff_t(batch.events.size());
    std::ranges::copy_if(part.events, std::back_inserter(batch.events), [&](const Event& event) {
        return channel_at(filter_, event.x, event.y) == channel;
    });
    std::ranges::inplace_merge(batch.events, batch.events.begin() + before, {}, &Event::t);
}

}  // namespace eventide
