// latent maps -> frames -> sinks: what the frame clock asks for, when its latent maps are there.
#pragma once

#include "pipeline/counters.h"
#include "pipeline/frame_clock.h"
#include "pipeline/live_changes.h"
#include "pipeline/pace/frame_dropper.h"
#include "pipeline/pace/latency_keeper.h"
#include "pipeline/silence_guard.h"
#include "pipeline/sink.h"
#include "pipeline/stages.h"
#include "pipeline/stop_request.h"
#include "src/core/frame_stamp.h"
#include "src/core/sensor_limits.h"

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace eventide {

/// What the encode thread hands on.
struct Encoded {
    LatentMap latent;
    Array2<float> event_preview;  ///< empty where not asked for
};

/// Render thread. A frame whose time lies in event window k is rendered when latent map k +
/// lookahead has come; at the end of the stream, and before a clock reset, without
/// those that will not come (the live edge).
class FrameOutput {
public:
    static constexpr int kMaxLookahead = eventide::kMaxLookahead;

    struct Settings {
        FrameRate rate;
        std::optional<SensorTime> from{};  ///< no frame before
        int lookahead = 0;                 ///< 0 to kMaxLookahead
        bool live = false;                 ///< may skip frames
        std::size_t waits_at_most =
            1;                       ///< event windows behind this one, before frames are skipped
        bool allow_silence = false;  ///< no limit to frames in a row without events
        LiveChanges* changes = nullptr;  ///< looked at once for each event window; null: none
        unsigned halvings = 0;  ///< every 2^n-th frame of the clock is rendered, to begin with
    };

    /// `waiting()` tells how many event windows stand behind the one at hand.
    FrameOutput(RenderStage& renderer, std::vector<Sink*> sinks, const Settings& settings,
                std::function<std::size_t()> waiting, const StopRequest& stop, Counters& counters,
                LatencyKeeper& keeper);

    /// Throws what a sink throws, and Error (input) before it writes more than SilenceGuard::kMost
    /// in a row or one that is not finite. False when no more frames are wanted.
    bool take(Encoded& encoded) {
        accept(encoded);
        return present();
    }
    /// The first half: nothing of `encoded` is needed afterwards; its codes may be others.
    void accept(Encoded& encoded);
    /// The second: the frames whose latent maps are there.
    bool present();

    /// Nothing more comes: the frames that still wait for later latent maps.
    bool finish();

    /// Closes all sinks, whatever happened; then throws the first error of those.
    void close();

private:
    /// An event window whose frames are not rendered yet.
    struct Waiting : WindowStamp {
        Array2<float> event_preview;
    };
    void change();
    void present_oldest();
    void tell_lookahead();
    void open_dropper();
    bool is_watched() const;
    void check_silence(const Waiting& held);
    void check_finite();
    HostTime::duration present(const DueFrame& due, Waiting& from);

    RenderStage& renderer_;
    std::vector<Sink*> sinks_;
    const Settings settings_;
    std::function<std::size_t()> waiting_;
    const StopRequest& stop_;
    Counters& counters_;
    LatencyKeeper& keeper_;
    int lookahead_;
    unsigned halvings_;
    FrameSchedule schedule_;
    FrameDropper dropper_;
    std::array<Waiting, kMaxLookahead + 1> held_;  // a ring
    std::size_t oldest_ = 0, held_count_ = 0;
    std::optional<std::size_t> told_lookahead_;  // to the sinks
    SilenceGuard silence_;
    GapCarrier gaps_;
    HostTime arrived_{};  // of the newest latent map
    Frame frame_;
    bool wanted_ = true;
};

}  // namespace eventide
