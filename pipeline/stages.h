// What the pipeline asks of a model and of whatever stands between parser and slicer.
#pragma once

#include "src/core/encode_stage.h"
#include "src/core/event.h"
#include "src/core/frame_data.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace eventide {

/// latent maps + time -> frame. One at a time; render thread.
class RenderStage {
public:
    virtual ~RenderStage() = default;
    virtual Frame make_output() const = 0;
    /// The next event window's latent map; its window follows the one before. May keep the codes,
    /// and leave those of a map before in their place.
    virtual void take(LatentMap& latent) noexcept = 0;
    /// No latent map will come any more, until reset(): the rest is rendered at the live edge.
    virtual void finish() noexcept = 0;
    /// Fills `frame.intensity` and `frame.sigma`; the pipeline fills the rest. t lies in `window`,
    /// (begin, end] and for the first one also its begin, which is the newest one taken or at most
    /// two before it. As many latent maps were taken as the lookahead says, and not one more.
    virtual void render(SensorTime t, const Window& window, Frame& frame) noexcept = 0;
    virtual void reset() noexcept = 0;  ///< as constructed

    // Between frames, while it runs; false where the stage cannot.
    virtual bool change_lookahead(int) { return false; }
    /// `frame` becomes one of that size, and the frames from now on. Throws Error where such a size
    /// is impossible, and stays as it was.
    virtual bool change_size(int, int, Frame&) { return false; }
};

/// Light that flickers in what a sensor sees.
struct FlickerFound {
    double hz = 0;               ///< now; 0: none does
    double last_hz = 0;          ///< when it last did; 0: it never did
    std::uint64_t left_out = 0;  ///< events that it added
};

/// events -> fewer events, before they are sliced (hot pixels, for example). Bin thread.
class EventFilter {
public:
    virtual ~EventFilter() = default;
    /// Events become those that come out now; the order stays.
    virtual void process(std::vector<Event>& events) = 0;

    // For filters that hold events back until they know more. The vectors given are empty.
    /// Those that come out as time goes on: no event before `now` will come any more.
    virtual void release(SensorTime, std::vector<Event>&) {}
    virtual void flush(std::vector<Event>&) {}  ///< all of them
    /// Once all events before `now` were processed, none before this time will come out any more.
    virtual SensorTime known_until(SensorTime now) const { return now; }
    virtual std::size_t held() const { return 0; }

    virtual FlickerFound flicker() const { return {}; }  ///< of one that looks for it
};

/// Sees all data the parser gives (images, inertial samples), before the filter. Bin thread; it
/// holds up the pipeline for as long as it takes.
class DataObserver {
public:
    virtual ~DataObserver() = default;
    virtual void see(const Batch& batch) = 0;
};

}  // namespace eventide
