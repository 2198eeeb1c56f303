// The version and the last error of this thread, for both libraries.
#include <eventide/eventide.h>
#include <eventide/version.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

namespace {

thread_local std::array<char, 1024> last_message{};

}  // namespace

extern "C" {

const char* eventide_version(void) {
    return eventide::version();
}

const char* eventide_error_message(void) {
    return last_message.data();
}

eventide_status eventide_set_error(eventide_status status, const char* message) {
    const std::string_view text = message == nullptr ? "" : message;
    const std::size_t length = std::min(text.size(), last_message.size() - 1);
    // The message may be the kept one, or a part of it.
    std::memmove(last_message.data(), text.data(), length);
    last_message[length] = '\0';
    return status;
}
}
