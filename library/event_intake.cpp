// What a caller pushes -> event windows.
#include "library/event_intake.h"

#include "library/far_time.h"
#include "library/pushed_images.h"
#include "src/binning/push_filtered.h"
#include "src/core/error.h"

#include <string>
#include <utility>

namespace eventide {

EventIntake::EventIntake(const SlicerSettings& settings, int width, int height,
                         std::unique_ptr<EventFilters> filter, ReconstructorCounters& counters)
    : width_(unsigned(width)),
      height_(unsigned(height)),
      slicer_(settings, width, height),
      filter_(std::move(filter)),
      counters_(counters) {}

void EventIntake::push(std::span<const Event> events, HostTime arrived) {
    check_open("push");
    take(events, StepBack::is_disorder, arrived);
    note_cut();
}

void EventIntake::push(const Batch& batch, HostTime arrived) {
    check_open("push");
    for (const ReferenceImage& image : batch.images) check_image(image);
    const std::span<const Event> events = batch.events;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < batch.images.size(); ++i) {
        if (const std::size_t place = batch.place_of_image(i); place > taken) {
            take(events.subspan(taken, place - taken), StepBack::is_new_clock, arrived);
            taken = place;
        }
        hold(batch.images[i]);
    }
    take(events.subspan(taken), StepBack::is_new_clock, arrived);
    note_cut();
}

void EventIntake::hold(const ReferenceImage& image) {
    if (is_far(image)) {
        ++counters_.bad_time;
        return;
    }
    if (holds_images_) images_.push_back({without_mosaic(image), slicer_.heard()});
    slicer_.push_reference(image.t);
}

std::optional<ReferenceImage> EventIntake::next_image() {
    if (images_.empty() || slicer_.ended_before(images_.front().since)) return std::nullopt;
    std::optional<ReferenceImage> image{std::move(images_.front().image)};
    images_.pop_front();
    return image;
}

void EventIntake::take(std::span<const Event> events, StepBack step_back, HostTime arrived) {
    counters_.events += events.size();
    taken_.clear();
    for (const Event& event : events) {
        if (!is_sound(event)) continue;
        if (step_back == StepBack::is_disorder && newest_ && event.t < *newest_) {
            ++counters_.time_backwards;
            continue;
        }
        newest_ = event.t;
        taken_.push_back(event);
    }
    if (!taken_.empty()) slicer_.look_behind(taken_.back().t, arrived);
    if (!filter_) return slicer_.push(taken_, arrived);
    counters_.filtered += push_filtered(slicer_, taken_, *filter_, arrived);
}

bool EventIntake::is_sound(const Event& event) {
    if (event.x >= width_ || event.y >= height_) {
        ++counters_.off_sensor;
        return false;
    }
    if (is_far(event.t)) {
        ++counters_.bad_time;
        return false;
    }
    return true;
}

void EventIntake::advance(SensorTime now) {
    check_open("advance");
    refuse_far(now, "advance");
    if (!filter_) return slicer_.advance(now, Clock::now());
    counters_.filtered += advance_filtered(slicer_, now, *filter_, taken_, Clock::now());
    note_cut();
}

void EventIntake::finish(std::optional<SensorTime> end) {
    if (finished_) return;
    if (end) refuse_far(*end, "finish");
    if (filter_) counters_.filtered += flush_filtered(slicer_, *filter_, taken_, Clock::now());
    // A stream without any event has no frames, even though its clock ran.
    if (end && slicer_.has_begun()) slicer_.advance(*end, Clock::now());
    slicer_.finish();
    note_cut();
    finished_ = true;
}

void EventIntake::note_cut() {
    const SlicerCounters& cut = slicer_.counters();
    counters_.late = cut.late;
    counters_.left_out = cut.too_many;
    counters_.time_resets = cut.time_resets;
}

void EventIntake::reset() {
    slicer_.reset();
    images_.clear();
    newest_.reset();
    finished_ = false;
    if (filter_) filter_->forget_scene();
}

void EventIntake::check_open(const char* what) const {
    if (finished_)
        throw Error(ErrorKind::usage, std::string{what} +
                                          ": expected a stream that goes on, found one after "
                                          "finish(); reset() begins another");
}

}  // namespace eventide
