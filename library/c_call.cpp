// What every function of the C interface does around its work.
#include "library/c_call.h"

#include <eventide/version.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace eventide {
namespace {

thread_local std::array<char, 1024> last_message{};

}  // namespace

eventide_status failed(eventide_status status, const char* message) noexcept {
    const std::size_t length = std::min(std::strlen(message), last_message.size() - 1);
    std::memcpy(last_message.data(), message, length);
    last_message[length] = '\0';
    return status;
}

}  // namespace eventide

extern "C" {

const char* eventide_version(void) {
    return eventide::version();
}

const char* eventide_error_message(void) {
    return eventide::last_message.data();
}
}
