// A renderer whose frames are corrected by the camera's own images.
#include "src/model/render/fused_renderer.h"

#include "src/core/error.h"
#include "src/model/render/sampling.h"

#include <algorithm>
#include <new>
#include <string>
#include <utility>

namespace eventide {

FusedRenderer::FusedRenderer(Renderer& renderer, int sensor_width, int sensor_height, int lookahead)
    : renderer_(renderer), width_(sensor_width), height_(sensor_height), lookahead_(lookahead) {
    if (lookahead < 0 || lookahead >= int(waiting_.size()))
        throw Error(ErrorKind::usage,
                    "lookahead: expected 0, 1 or 2, found " + std::to_string(lookahead));
}

/// All or nothing.
void FusedRenderer::prepare(const RenderRequest& request) {
    if (fusion_) {
        Frame shown = renderer_.make_output(shown_for(request, {}));
        fusion_->prepare(request);
        shown_ = std::move(shown);
    }
    prepared_ = request;
}

/// All or nothing.
void FusedRenderer::begin() {
    ImageFusion fusion{width_, height_};
    fusion.prepare(prepared_);
    shown_ = renderer_.make_output(shown_for(prepared_, {}));
    for (Waiting& waiting : waiting_) waiting.events = Array2<float>(height_, width_);
    fusion_.emplace(std::move(fusion));
}

void FusedRenderer::reset() noexcept {
    if (fusion_) fusion_->reset();
    active_ = began_ = is_silent_before_ = false;
    waiting_count_ = 0;
    newest_used_ = SensorTime::min();
    dropped_ += images_.size();
    images_.clear();
}

void FusedRenderer::give(ReferenceImage image) noexcept {
    if (image.pixels.empty()) return;
    try {
        if (!fusion_) begin();
        images_.push_back(std::move(image));
    } catch (const std::bad_alloc&) {
        ++dropped_;
        return;
    }
    if (images_.size() <= most_waiting_) return;
    images_.pop_front();
    ++dropped_;
}

/// With lookahead 1 window n waits for the images before n + 1 ends:
///
///     push()     n - 1    n              n + 1
///     settles             n - 1          n            advance(), then the images until its end
void FusedRenderer::push(const Window& window, const Array2<float>& events) noexcept {
    if (!active_ && due_images(window) == 0) {
        began_ = true;
        return;
    }
    if (!active_ && began_) fusion_->begin_within_stream();
    active_ = true;
    Waiting& newest = waiting_[(oldest_ + waiting_count_++) % waiting_.size()];
    newest.window = window;
    std::ranges::copy(events.values(), newest.events.values().begin());
    newest.is_silent = std::ranges::all_of(events.values(), [](float n) { return n == 0; });
    while (waiting_count_ > std::size_t(lookahead_)) settle_oldest();
}

void FusedRenderer::settle_oldest() noexcept {
    const Waiting& settled = waiting_[oldest_];
    oldest_ = (oldest_ + 1) % waiting_.size();
    --waiting_count_;
    // Where frames stay as they were, nothing needs to be looked for, but for a new image's sake.
    const bool follow = (!shows_as_before(settled) || due_images(settled.window) > 0) &&
                        renderer_.ready(settled.window.end, lookahead_);
    is_silent_before_ = settled.is_silent;
    if (follow) show(settled.window.end);
    fusion_->advance(settled.window, settled.events, follow ? &shown_ : nullptr);
    use_until(settled.window);
}

/// Whether the frame at its end is that at the end of the window before: nothing happened in
/// either, nor in those that its lookahead reads.
bool FusedRenderer::shows_as_before(const Waiting& settled) const {
    if (!renderer_.rests_in_silence() || waiting_count_ < std::size_t(lookahead_)) return false;
    bool is_silent = is_silent_before_ && settled.is_silent;
    for (std::size_t i = 0; i < waiting_count_; ++i)
        is_silent = is_silent && waiting_[(oldest_ + i) % waiting_.size()].is_silent;
    return is_silent;
}

std::ptrdiff_t FusedRenderer::due_images(const Window& window) const {
    return std::ranges::count_if(
        images_, [&](const ReferenceImage& image) { return image.t <= window.end; });
}

/// In the order in which they came. One whose time has not come when that of a later one has bears
/// a time that is wrong.
void FusedRenderer::use_until(const Window& window) noexcept {
    for (std::ptrdiff_t due = due_images(window); due > 0; images_.pop_front())
        if (images_.front().t <= window.end) {
            use(images_.front(), window);
            --due;
        } else {
            ++dropped_;
        }
}

/// With the sigma that frames have: the renderer keeps what it rendered, and a frame asked for at
/// that time is a copy.
RenderRequest FusedRenderer::shown_for(const RenderRequest& request, SensorTime t) const {
    return {.t = t,
            .lookahead = lookahead_,
            .sigma_rule = request.sigma_rule,
            .want_sigma = request.want_sigma};
}

bool FusedRenderer::is_sensors(const RenderRequest& request) const {
    return geometry_of(request, width_, height_) == geometry_of({}, width_, height_);
}

void FusedRenderer::show(SensorTime t) noexcept {
    renderer_.render(shown_for(prepared_, t), shown_);
}

void FusedRenderer::use(const ReferenceImage& image, const Window& window) noexcept {
    if (image.t < newest_used_) {
        ++dropped_;
        return;
    }
    newest_used_ = image.t;
    // What the model showed when the image was taken; where that is no longer known, as soon after
    // that as it is.
    SensorTime t = std::max(image.t, renderer_.oldest());
    if (!renderer_.ready(t, lookahead_)) t = window.end;
    show(t);
    ++(fusion_->correct(image, shown_) ? used_ : dropped_);
}

void FusedRenderer::render(const RenderRequest& request, Frame& frame) noexcept {
    // The frame's own window and those before it, where they still wait.
    while (waiting_count_ > 0 && waiting_[oldest_].window.begin < request.t) settle_oldest();
    renderer_.render(request, frame);
    if (!active_) return;
    const bool shows_it = is_sensors(request);
    if (!shows_it) show(request.t);
    fusion_->apply(request, shows_it ? frame.intensity : shown_.intensity, frame);
}

}  // namespace eventide
