// Several sinks behind one.
#include "pipeline/sinks/fan_out.h"

#include <algorithm>
#include <exception>
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
    std::exception_ptr first;
    for (const auto& sink : sinks_) {
        try {
            sink->close();
        } catch (...) {
            if (!first) first = std::current_exception();
        }
    }
    if (first) std::rethrow_exception(first);
}

bool FanOut::wants_more() const {
    return std::ranges::all_of(sinks_, [](const auto& sink) { return sink->wants_more(); });
}

bool FanOut::is_watched() const {
    return std::ranges::any_of(sinks_, [](const auto& sink) { return sink->is_watched(); });
}

}  // namespace eventide
