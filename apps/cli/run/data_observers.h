// Who of a run looks at what was read, beside the network.
#pragma once

#include "apps/cli/run/colour.h"
#include "apps/cli/run/events_out.h"
#include "apps/cli/run/reference_images.h"
#include "pipeline/images_on_the_way.h"
#include "pipeline/stages.h"

#include <optional>

namespace eventide::app {

/// Each is borrowed, and may be null: nobody wants it. Bin thread.
class DataObservers final : public DataObserver {
public:
    /// `filter`: as demosaiced() takes it.
    DataObservers(ReferenceImages* shown, ImagesOnTheWay* corrections,
                  std::optional<ColourFilter> filter)
        : filter_{filter}, shown_{shown}, corrections_{corrections} {}

    void hand_all_to(EventsOut* file) { file_ = file; }
    void hand_images_to(ColourNetworks& networks) { networks_ = &networks; }

    void see(const Batch& batch) override;

private:
    std::optional<ColourFilter> filter_;
    ReferenceImages* shown_;
    ImagesOnTheWay* corrections_;
    ColourNetworks* networks_ = nullptr;
    EventsOut* file_ = nullptr;
};

}  // namespace eventide::app
