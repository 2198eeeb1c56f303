// The parts of the module.
#pragma once

#include "python/call_lock.h"
#include "python/lock.h"

#include <eventide/reconstructor.h>

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace eventide::python {

/// What is used by one thread at a time, guarded: Python's threads run while the library works.
template <typename T>
struct Guarded {
    template <typename... Arguments>
    explicit Guarded(Arguments&&... arguments) : it(std::forward<Arguments>(arguments)...) {}

    /// Runs `body(it)` without Python's lock. Throws Error (usage) within another call of it.
    template <typename Body>
    auto with(Body body) {
        const Unlocked unlocked;
        const std::lock_guard lock{mutex};
        return body(it);
    }
    /// For a body that only looks, also within another call of it.
    template <typename Body>
    auto look(Body body) {
        return mutex.is_held_here() ? body(it) : with(body);
    }

    T it;
    CallLock mutex;
};

/// With the size of its options, which render() starts from.
struct GuardedReconstructor : Guarded<Reconstructor> {
    GuardedReconstructor(const std::string& model, int width, int height,
                         const ReconstructorOptions& options)
        : Guarded(model, width, height, options), size(options.size) {}
    FrameSize size;
};

inline std::optional<std::int64_t> us_of(std::optional<SensorTime> t) {
    return t ? std::optional{to_us(*t)} : std::nullopt;
}

/// Throws TypeError, naming what is wanted and what was found.
template <typename T>
T cast_to(const char* name, pybind11::handle value) {
    using Caster = pybind11::detail::make_caster<T>;
    Caster caster;
    if (!caster.load(value, true))
        throw pybind11::type_error(std::string{name} + ": expected " + Caster::name.text +
                                   ", found " + std::string(pybind11::repr(value)));
    return pybind11::detail::cast_op<T>(std::move(caster));
}

/// The options of Reconstructor by name, the others as they are. Throws Error (usage) for unknown
/// ones, TypeError for values of another type.
ReconstructorOptions options_of(const pybind11::dict& given);

using FramePointer = std::shared_ptr<Frame>;

/// The array, which keeps `owner` of the frame, or None where sigma was not asked for.
pybind11::object sigma_of(const Frame& frame, pybind11::handle owner);

void add_errors(pybind11::module_& module);
void add_frame(pybind11::module_& module);
void add_reconstructor(pybind11::module_& module);
void add_sources(pybind11::module_& module);
void add_simulation(pybind11::module_& module);
void add_measures(pybind11::module_& module);
void add_pipeline(pybind11::module_& module);

}  // namespace eventide::python
