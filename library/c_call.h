// What every function of the C interface does around its work.
#pragma once

#include <eventide/error.h>
#include <eventide/event.h>
#include <eventide/eventide.h>

#include <exception>
#include <new>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// Runs `body`, which returns a status; what it throws becomes one.
template <typename Body>
eventide_status c_call(Body body) noexcept {
    try {
        return body();
    } catch (const Error& error) {
        return eventide_set_error(eventide_status(error.kind()), error.what());
    } catch (const std::bad_alloc&) {
        return eventide_set_error(EVENTIDE_FAILED, "expected enough memory, found too little");
    } catch (const std::exception& error) {
        return eventide_set_error(EVENTIDE_FAILED, error.what());
    } catch (...) {
        return eventide_set_error(EVENTIDE_FAILED, "unknown error");
    }
}

/// Throws Error (usage).
template <typename T>
T& given(T* argument, const char* what) {
    if (argument == nullptr)
        throw Error(ErrorKind::usage, std::string{"expected "} + what + ", found NULL");
    return *argument;
}

/// The same events in C++; `into` keeps its memory. Throws Error (usage) for NULL with a count.
std::span<const Event> events_of(const eventide_event* events, std::size_t count,
                                 std::vector<Event>& into);

}  // namespace eventide
