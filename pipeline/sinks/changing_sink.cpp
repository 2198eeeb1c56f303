#include "pipeline/sinks/changing_sink.h"

#include "pipeline/first_error.h"

#include <algorithm>
#include <utility>

namespace eventide {

ChangingSink::ChangingSink(std::vector<std::unique_ptr<Sink>> behind)
    : behind_{std::move(behind)} {}

void ChangingSink::write(const Frame& frame) {
    const Frame& shown = changed(frame);
    for (const auto& sink : behind_) sink->write(shown);
}

void ChangingSink::lookahead_is(int windows) {
    for (const auto& sink : behind_) sink->lookahead_is(windows);
}

void ChangingSink::close() {
    FirstError error;
    for (const auto& sink : behind_) error.guard([&] { sink->close(); });
    error.rethrow_if_any();
}

bool ChangingSink::wants_more() const {
    return std::ranges::all_of(behind_, [](const auto& sink) { return sink->wants_more(); });
}

bool ChangingSink::is_watched() const {
    return std::ranges::any_of(behind_, [](const auto& sink) { return sink->is_watched(); });
}

HostTime::duration ChangingSink::held() const {
    HostTime::duration sum{};
    for (const auto& sink : behind_) sum += sink->held();
    return sum;
}

}  // namespace eventide
