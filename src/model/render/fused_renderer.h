// A renderer whose frames are corrected by the camera's own images, window by window.
#pragma once

#include "src/model/render/image_fusion.h"

#include <array>
#include <deque>
#include <optional>

namespace eventide {

/// Stands beside a Renderer, which it borrows, and sees the same event windows. Frames of a
/// window know the images that were given before the window was pushed, or before those that its
/// lookahead waits for. One thread at a time; nothing fails after construction. What corrections
/// take (some 200 bytes a pixel) is taken with the first image: most sensors give none.
class FusedRenderer {
public:
    /// Throws Error (usage) for a lookahead that is not 0, 1 or 2.
    FusedRenderer(Renderer& renderer, int sensor_width, int sensor_height, int lookahead);

    void reset() noexcept;

    /// In order of time: one that is older than one used before is dropped, and one whose time has
    /// not come when that of a later one has. Of more images whose time has not come than may wait
    /// the oldest are dropped; so are those that there is no memory for. One without pixels tells
    /// nothing.
    void give(ReferenceImage image) noexcept;
    /// give() of those that came before a window: what `next` returns until it is empty. Returns
    /// whether there was one.
    template <typename Next>
    bool give_all(Next next) noexcept {
        bool any = false;
        for (; std::optional<ReferenceImage> image = next(); any = true) give(std::move(*image));
        return any;
    }

    /// After Renderer::push() of the same window; events per pixel, [y][x] of the sensor.
    void push(const Window& window, const Array2<float>& events) noexcept;

    /// 0, 1 or 2, as of the next window pushed.
    void change_lookahead(int lookahead) noexcept { lookahead_ = lookahead; }

    /// The memory that the correction takes for requests of this size and region. Throws
    /// std::bad_alloc, and is then prepared as it was.
    void prepare(const RenderRequest& request);

    /// As Renderer::render() of a request that was prepared for, for times that do not decrease by
    /// more than their window.
    void render(const RenderRequest& request, Frame& frame) noexcept;

    std::uint64_t used() const { return used_; }  ///< images that corrected something
    /// Images that came too late, in too great a number, or before a reset.
    std::uint64_t dropped() const { return dropped_; }

    /// How many images wait at most: of a live source; of a recording, whose images may all come
    /// before its events.
    static constexpr std::size_t kMaxWaiting = 64, kMaxWaitingOfRecording = 1024;
    /// So many instead of kMaxWaiting. Call it before the first image.
    void keep_at_most(std::size_t images) { most_waiting_ = images; }

private:
    /// A window and its events, until the images that frames of it may know have come: a ring, from
    /// oldest_ on waiting_count_ of 3.
    struct Waiting {
        Window window{};
        Array2<float> events;
        bool is_silent = false;
    };
    void begin();
    RenderRequest shown_for(const RenderRequest& request, SensorTime t) const;
    bool is_sensors(const RenderRequest& request) const;
    void settle_oldest() noexcept;
    bool shows_as_before(const Waiting& settled) const;
    std::ptrdiff_t due_images(const Window& window) const;
    void use_until(const Window& window) noexcept;
    void show(SensorTime t) noexcept;
    void use(const ReferenceImage& image, const Window& window) noexcept;

    Renderer& renderer_;
    int width_, height_;  // px, of the sensor
    int lookahead_;
    std::size_t most_waiting_ = kMaxWaiting;
    RenderRequest prepared_;
    bool active_ = false;                // since the first image's window; before, nothing is spent
    bool began_ = false;                 // there were windows before it
    std::optional<ImageFusion> fusion_;  // none: before the first image
    Frame shown_;                        // by the model alone, at the time asked last
    bool is_silent_before_ = false;      // the window settled last
    std::array<Waiting, 3> waiting_;     // windows that the lookahead holds back
    std::size_t oldest_ = 0, waiting_count_ = 0;
    std::deque<ReferenceImage> images_;
    SensorTime newest_used_ = SensorTime::min();
    std::uint64_t used_ = 0, dropped_ = 0;
};

}  // namespace eventide
