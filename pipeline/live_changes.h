// What may be changed while a pipeline runs: asked for by any thread, taken by the render thread,
// and how events are cut by the bin thread.
#pragma once

#include "pipeline/frame_clock.h"
#include "src/binning/slicer_settings.h"

#include <atomic>
#include <mutex>
#include <optional>
#include <utility>

namespace eventide {

class LiveChanges {
public:
    struct Wanted {
        std::optional<FrameRate> rate;  ///< of sensor time
        std::optional<int> lookahead;   ///< 0 to 2 event windows
        /// n: every 2^n-th of the clock's frames is rendered.
        std::optional<unsigned> halvings;
        struct Pixels {
            int width = 0, height = 0;
        };
        std::optional<Pixels> size;  ///< of the frames
    };

    void set_rate(const FrameRate& rate) {
        ask([&] { wanted_.rate = rate; });
    }
    void set_lookahead(int windows) {
        ask([&] { wanted_.lookahead = windows; });
    }
    void set_halvings(unsigned halvings) {
        ask([&] { wanted_.halvings = halvings; });
    }
    void set_size(int width, int height) {
        ask([&] { wanted_.size = Wanted::Pixels{width, height}; });
    }

    /// As Slicer::change() takes it.
    void set_window(const SlicerSettings& window) {
        const std::lock_guard lock{mutex_};
        window_ = window;
        any_window_ = true;
    }

    /// The window that was asked for since the last time; bin thread, once for each packet.
    std::optional<SlicerSettings> take_window() {
        if (!any_window_.exchange(false)) return std::nullopt;
        const std::lock_guard lock{mutex_};
        return std::exchange(window_, std::nullopt);
    }

    /// What was asked for since the last time; once for each event window, so it costs a load where
    /// nothing was.
    Wanted take() {
        if (!any_.exchange(false)) return {};
        const std::lock_guard lock{mutex_};
        return std::exchange(wanted_, {});
    }

private:
    template <typename Body>
    void ask(Body body) {
        const std::lock_guard lock{mutex_};
        body();
        any_ = true;
    }
    std::mutex mutex_;
    Wanted wanted_;
    std::optional<SlicerSettings> window_;
    std::atomic<bool> any_{false}, any_window_{false};
};

}  // namespace eventide
