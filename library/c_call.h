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

/// Keeps the words for eventide_error_message(). Thread: its own. Shown to libeventide.so alone
/// (exported_frames.map), so that the words of both libraries are kept in one place.
EVENTIDE_API eventide_status failed(eventide_status status, const char* message) noexcept;

/// Runs `body`, which returns a status; what it throws becomes one.
template <typename Body>
eventide_status c_call(Body body) noexcept {
    try {
        return body();
    } catch (const Error& error) {
        return failed(eventide_status(error.kind()), error.what());
    } catch (const std::bad_alloc&) {
        return failed(EVENTIDE_FAILED, "expected enough memory, found too little");
    } catch (const std::exception& error) {
        return failed(EVENTIDE_FAILED, error.what());
    } catch (...) {
        return failed(EVENTIDE_FAILED, "unknown error");
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
