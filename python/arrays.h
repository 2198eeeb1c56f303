// Between NumPy's arrays and the library's types.
#pragma once

#include <eventide/event.h>
#include <eventide/frame.h>

#include <pybind11/numpy.h>

#include <functional>
#include <vector>

namespace eventide::python {

/// The events of a structured array with the fields t, x, y and p, on, pol or polarity, appended to
/// `into`. Coordinates that no sensor has become ones outside every sensor. Throws Error (usage)
/// naming the field.
void append_events(const pybind11::array& array, std::vector<Event>& into);

/// The same of a large array, piece by piece: `take` is called with each in `piece`, and signals
/// are heard between them. An array without events is one piece.
void in_pieces(const pybind11::array& array, std::vector<Event>& piece,
               const std::function<void()>& take);

/// A structured array (t, x, y, on) that owns these events; nothing is copied.
pybind11::array array_of(std::vector<Event> events);

/// [y][x], as long as `owner` lives; nothing is copied.
pybind11::array_t<float> array_of(const Array2<float>& plane, pybind11::handle owner);

/// An array that owns these pixels, [y][x]; nothing is copied.
pybind11::array_t<float> array_of(Array2<float> plane);

/// A copy of a plane of floats or truths. Throws Error (usage) naming `what` for other arrays, as
/// those of 0 to 255.
Array2<float> plane_of(const pybind11::array& array, const char* what);

/// [y][x] or [y][x][channel].
pybind11::array array_of(const ReferenceImage& image);

/// The reverse, of uint8 or uint16; its times and place are not set. Throws Error (usage) for other
/// arrays.
ReferenceImage image_of(const pybind11::array& array);

}  // namespace eventide::python
