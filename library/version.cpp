// Which version is loaded.
#include <eventide/version.h>

#define EVENTIDE_TEXT_OF(x) #x
#define EVENTIDE_TEXT(x) EVENTIDE_TEXT_OF(x)

namespace eventide {

const char* version() noexcept {
    return EVENTIDE_TEXT(EVENTIDE_VERSION_MAJOR) "." EVENTIDE_TEXT(
        EVENTIDE_VERSION_MINOR) "." EVENTIDE_TEXT(EVENTIDE_VERSION_PATCH);
}

}  // namespace eventide
