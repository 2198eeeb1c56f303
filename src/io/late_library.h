// Libraries that are loaded when they are first used: what they bring with them costs start-up time
// and memory that most runs need for nothing.
#pragma once

namespace eventide {

/// A library that stays loaded. Thread: any.
class LateLibrary {
public:
    /// Loads it by `soname`, the name by which a program linked with it would. Throws Error
    /// (failed) naming what needs it, what the system says, and Debian's package.
    LateLibrary(const char* soname, const char* needed_for, const char* package);

    /// Throws Error (failed) where it has none of this (mangled) name.
    template <typename Function>
    void find(Function*& function, const char* name) const {
        function = reinterpret_cast<Function*>(address_of(name));
    }

private:
    void* address_of(const char* name) const;
    const char* soname_;
    void* library_;
};

}  // namespace eventide
