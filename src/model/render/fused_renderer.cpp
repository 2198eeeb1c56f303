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

void FusedRenderer::prepare(const RenderRequest& request) {
    prepared_ = request;
    if (!fusion_) return;
    fusion_->prepare(request);
    shown_ = renderer_.make_output(request_at({}));
}

/// All or nothing.
void FusedRenderer::begin() {
    ImageFusion fusion{width_, height_};
    fusion.prepare(prepared_);
    shown_ = renderer_.make_output(request_at({}));
    for (Waiting& waiting : waiting_) waiting.events = Array2<float>(height_, width_);
    fusion_.emplace(std::move(fusion));
}

void FusedRenderer::reset() noexcept {
    if (fusion_) fusion_->reset();
    active_ = silent_before_ = false;
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
    active_ = active_ || std::ranges::any_of(images_, [&](const ReferenceImage& image) {
                  return image.t <= window.end;
              });
    if (!active_) return;
    if (waiting_count_ == waiting_.size()) settle_oldest();
    Waiting& newest = waiting_[(oldest_ + waiting_count_++) % waiting_.size()];
    newest.window = window;
    std::ranges::copy(events.values(), newest.events.values().begin());
    while (waiting_count_ > std::size_t(lookahead_)) settle_oldest();
}

void FusedRenderer::settle_oldest() noexcept {
    const Waiting& settled = waiting_[oldest_];
    oldest_ = (oldest_ + 1) % waiting_.size();
    --waiting_count_;
    const bool silent =
        std::ranges::all_of(settled.events.values(), [](float n) { return n == 0; });
    // From the second silent window on frames stay as they are, and nothing needs to be looked for.
    const bool follow =
        !(silent && silent_before_) && renderer_.ready(settled.window.end, lookahead_);
    silent_before_ = silent;
    if (follow) show(settled.window.end);
    fusion_->advance(settled.window, settled.events, follow ? &shown_ : nullptr);
    use_until(settled.window);
}

/// In the order in which they came. One whose time has not come when that of a later one has bears
/// a time that is wrong.
void FusedRenderer::use_until(const Window& window) noexcept {
    const auto is_due = [&](const ReferenceImage& image) { return image.t <= window.end; };
    const auto due = std::ranges::count_if(images_, is_due);
    for (std::ptrdiff_t used = 0; used < due; images_.pop_front())
        if (is_due(images_.front())) {
            use(images_.front(), window);
            ++used;
        } else {
            ++dropped_;
        }
}

/// With the sigma that frames have: the renderer keeps what it rendered, and a frame asked for at
/// that time is a copy.
RenderRequest FusedRenderer::request_at(SensorTime t) const {
    return {.t = t,
            .lookahead = lookahead_,
            .sigma_rule = prepared_.sigma_rule,
            .want_sigma = prepared_.want_sigma};
}

bool FusedRenderer::is_sensors(const RenderRequest& request) const {
    return geometry_of(request, width_, height_) == geometry_of({}, width_, height_);
}

void FusedRenderer::show(SensorTime t) noexcept {
    renderer_.render(request_at(t), shown_);
}

void FusedRenderer::use(const ReferenceImage& image, const Window& window) noexcept {
    if (image.t < newest_used_) {
        ++dropped_;
        return;
    }
    newest_used_ = image.t;
    // What the model showed when the image was taken; where that is no longer known, at the
    // window's begin.
    SensorTime t = image.t;
    if (!renderer_.ready(t, lookahead_)) t = window.begin + SensorDuration{1};
    if (!renderer_.ready(t, lookahead_)) t = window.end;
    show(t);
    ++(fusion_->correct(image, shown_) ? used_ : dropped_);
}

void FusedRenderer::render(const RenderRequest& request, Frame& frame) noexcept {
    // The frame's own window and those before it, where they still wait.
    while (waiting_count_ > 0 && waiting_[oldest_].window.begin < request.t) settle_oldest();
    renderer_.render(request, frame);
    if (!active_) return;
    frame.t = request.t;
    const bool shows_it = is_sensors(request);
    if (!shows_it) show(request.t);
    fusion_->apply(request, shows_it ? frame.intensity : shown_.intensity, frame);
}

}  // namespace eventide
