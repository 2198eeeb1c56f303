/// @file
/// Which version this is: semantic, major.minor.patch. The one place; the build reads it here.
#pragma once

/// What the shared library shows; everything else in it stays inside.
#define EVENTIDE_API __attribute__((visibility("default")))

/// Of the headers; raised where programs may have to be changed.
#define EVENTIDE_VERSION_MAJOR 1
/// Of the headers; raised when something is added.
#define EVENTIDE_VERSION_MINOR 0
/// Of the headers; raised for fixes.
#define EVENTIDE_VERSION_PATCH 0

#ifdef __cplusplus
/// The library in C++. An object that another was moved from is empty: it may be assigned to or
/// destroyed, and nothing else.
namespace eventide {

/// Version of the library that is loaded, "1.0.0"; the macros tell that of the headers a program
/// was compiled with.
EVENTIDE_API const char* version() noexcept;

}  // namespace eventide
#endif
