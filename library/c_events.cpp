// Events of the C interface in C++.
#include "library/c_call.h"

namespace eventide {

std::span<const Event> events_of(const eventide_event* events, std::size_t count,
                                 std::vector<Event>& into) {
    into.clear();
    if (count == 0) return into;
    given(events, "events");
    for (const eventide_event& e : std::span{events, count})
        into.push_back({from_us(e.t), e.x, e.y, e.on != 0 ? Polarity::on : Polarity::off});
    return into;
}

}  // namespace eventide
