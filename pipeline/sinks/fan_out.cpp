// Several sinks behind one.
#include "pipeline/sinks/fan_out.h"

#include "pipeline/first_error.h"

#include <algorithm>
#include <utility>

namespace eventide {

FanOut::FanOut(std::vector<std::unique_ptr<Sink>> sinks) : sinks_{std::move(sinks)} {}

void FanOut::write(const Frame& frame) {
    for (const auto& sink : sinks_) sink->write(frame);
}

void FanOut::lookahead_is(int windows) {
    for (const auto& sink : sinks_) sink->lookahead_is(windows);
}

void FanOut::close() {
    FirstError error;
    for (const auto& sink : sinks_) error.guard([&] { sink->close(); });
    error.rethrow_if_any();
}

bool FanOut::wants_more() const {
    return std::ranges::all_of(sinks_, [](const auto& sink) { return sink->wants_more(); });
}

bool FanOut::is_watched() const {
    return std::ranges::any_of(sinks_, [](const auto& sink) { return sink->is_watched(); });
}

HostTime::duration FanOut::held() const {
    HostTime::duration sum{};
    for (const auto& sink : sinks_) sum += sink->held();
    return sum;
}

}  // namespace eventide
