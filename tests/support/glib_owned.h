// Owners for GLib's reference-counted things.
#pragma once

#include <glib-object.h>

#include <memory>

namespace eventide::testing_support {

struct Unref {
    void operator()(gpointer object) const { g_object_unref(object); }
    void operator()(GError* error) const { g_error_free(error); }
};
template <typename T>
using Owned = std::unique_ptr<T, Unref>;

}  // namespace eventide::testing_support
