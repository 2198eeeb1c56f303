// What every function of the C interface does around its work.
#pragma once

#include <eventide/error.h>
#include <eventide/event.h>
#include <eventide/eventide.h>

#include <cstddef>
#include <cstring>
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

/// A caller compiled with older headers has a shorter struct: what it lacks stays as it is in
/// `whole`; NULL lacks all. Throws Error (usage) for the size of none, with `what` it is and, where
/// there is one, what sets the size.
template <typename T>
T filled_in(T whole, const T* argument, const char* what, const char* set_by = "") {
    if (argument == nullptr) return whole;
    const std::size_t size = argument->struct_size, least = sizeof argument->struct_size;
    if (size > sizeof whole || size < least || size % alignof(T) != 0)
        throw Error(ErrorKind::usage,
                    std::string{what} + ": expected a struct_size of " + std::to_string(least) +
                        " to " + std::to_string(sizeof whole) + ", a multiple of " +
                        std::to_string(alignof(T)) + set_by + ", found " + std::to_string(size));
    std::memcpy(&whole, argument, size);
    return whole;
}

/// The same events in C++; `into` keeps its memory. Throws Error (usage) for NULL with a count.
std::span<const Event> events_of(const eventide_event* events, std::size_t count,
                                 std::vector<Event>& into);

}  // namespace eventide
