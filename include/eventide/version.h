// Which version this is: semantic, major.minor.patch. The one place; the build reads it here.
#pragma once

/// What the shared library shows; everything else in it stays inside.
#define EVENTIDE_API __attribute__((visibility("default")))

#define EVENTIDE_VERSION_MAJOR 1
#define EVENTIDE_VERSION_MINOR 0
#define EVENTIDE_VERSION_PATCH 0

#ifdef __cplusplus
namespace eventide {

/// Of the library that is loaded, "1.0.0"; the macros are of the headers it was compiled with.
EVENTIDE_API const char* version() noexcept;

}  // namespace eventide
#endif
