/// @file
/// Which version this is: semantic, major.minor.patch. The one place; the build reads it here.
#pragma once

/// What the shared library shows; everything else in it stays inside.
#define EVENTIDE_API __attribute__((visibility("default")))

/// Of the headers; counts up where programs may have to be changed.
#define EVENTIDE_VERSION_MAJOR 1
/// Of the headers; counts up where something came to be.
#define EVENTIDE_VERSION_MINOR 0
/// Of the headers; counts up where something was put right.
#define EVENTIDE_VERSION_PATCH 0

#ifdef __cplusplus
/// The library in C++. An object that another was moved from is empty: it may be assigned to or
/// destroyed, and nothing else.
namespace eventide {

/// Of the library that is loaded, "1.0.0"; the macros are of the headers it was compiled with.
EVENTIDE_API const char* version() noexcept;

}  // namespace eventide
#endif
