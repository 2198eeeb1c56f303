// Between NumPy's arrays and the library's types.
#include "python/arrays.h"

#include "python/signals.h"
#include "src/core/list_text.h"
#include "src/core/sensor_limits.h"

#include <eventide/error.h>

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <memory>
#include <string>
#include <utility>

namespace eventide::python {

namespace py = pybind11;

namespace {

/// Row by row, a copy where it has to be. Made of another array by its constructor, which raises
/// what NumPy does where memory is short; ensure() would give none.
template <typename T>
using Plain = py::array_t<T, py::array::c_style | py::array::forcecast>;
using Numbers = Plain<std::int64_t>;

constexpr std::uint64_t kLargest = std::numeric_limits<std::int64_t>::max();

/// As 64-bit numbers. What is larger becomes the largest, which is no time and on no sensor.
Numbers numbers_of(const py::array& values) {
    if (values.dtype().kind() != 'u' || values.itemsize() < 8) return Numbers(values);
    const Plain<std::uint64_t> whole(values);
    Numbers clamped(whole.size());
    std::transform(whole.data(), whole.data() + whole.size(), clamped.mutable_data(),
                   [](std::uint64_t value) { return std::int64_t(std::min(value, kLargest)); });
    return clamped;
}

/// The field that has one of these names, as 64-bit numbers.
Numbers field(const py::array& array, std::initializer_list<const char*> names) {
    for (const char* name : names) {
        if (!array.dtype().attr("fields").contains(name)) continue;
        const py::array values = array[name];
        const char kind = values.dtype().kind();
        if (kind != 'i' && kind != 'u' && kind != 'b')
            throw Error(ErrorKind::usage, std::string{"events, field '"} + name +
                                              "': expected whole numbers, found " +
                                              std::string(py::str(values.dtype())));
        if (values.ndim() != 1)
            throw Error(ErrorKind::usage, std::string{"events, field '"} + name +
                                              "': expected one number of each event, found an "
                                              "array of " +
                                              std::to_string(values.ndim() - 1) + " dimensions");
        return numbers_of(values);
    }
    throw Error(ErrorKind::usage, "events: expected a field called " + list_of(names) + ", found " +
                                      std::string(py::str(array.dtype().attr("names"))));
}

/// As numbers, what is masked would be there again.
void refuse_mask(const py::array& array, const char* what) {
    if (py::isinstance(array, py::module_::import("numpy.ma").attr("MaskedArray")))
        throw Error(ErrorKind::usage,
                    std::string{what} +
                        ": expected an array without a mask, found a masked one; leave out what is "
                        "masked, or take all with numpy.asarray()");
}

void check_events(const py::array& array) {
    refuse_mask(array, "events");
    if (array.dtype().kind() != 'V' || array.dtype().attr("fields").is_none())
        throw Error(ErrorKind::usage,
                    "events: expected a structured array with fields t, x, y and p, found " +
                        std::string(py::str(array.dtype())));
    if (array.ndim() != 1)
        throw Error(ErrorKind::usage, "events: expected an array of one dimension, found " +
                                          std::to_string(array.ndim()));
}

std::uint16_t coordinate(std::int64_t value) {
    return value < 0 || value > 0xffff ? 0xffff : std::uint16_t(value);
}

/// Of Event, as it lies in memory.
py::dtype event_dtype() {
    static_assert(sizeof(Event) == 16 && offsetof(Event, x) == 8 && offsetof(Event, y) == 10 &&
                  offsetof(Event, polarity) == 12);
    py::list names, formats, offsets;
    for (const auto& [name, format, offset] :
         {std::tuple{"t", "<i8", 0}, {"x", "<u2", 8}, {"y", "<u2", 10}, {"on", "?", 12}}) {
        names.append(name);
        formats.append(format);
        offsets.append(offset);
    }
    return py::dtype(names, formats, offsets, sizeof(Event));
}

}  // namespace

void append_events(const py::array& array, std::vector<Event>& into) {
    check_events(array);
    const Numbers t = field(array, {"t", "ts", "timestamp", "time"}), x = field(array, {"x"}),
                  y = field(array, {"y"}), on = field(array, {"p", "on", "pol", "polarity"});
    const auto count = std::size_t(array.size());
    into.reserve(into.size() + count);
    for (std::size_t i = 0; i < count; ++i)
        into.push_back({from_us(t.data()[i]), coordinate(x.data()[i]), coordinate(y.data()[i]),
                        on.data()[i] > 0 ? Polarity::on : Polarity::off});
}

void in_pieces(const py::array& array, std::vector<Event>& piece,
               const std::function<void()>& take) {
    constexpr py::ssize_t kPiece = 65536;  // events, a few milliseconds
    check_events(array);
    const py::ssize_t size = array.size();
    for (py::ssize_t begin = 0; begin == 0 || begin < size; begin += kPiece) {
        if (begin > 0) check_signals();
        piece.clear();
        append_events(array[py::slice(begin, std::min(begin + kPiece, size), 1)], piece);
        take();
    }
}

py::array array_of(std::vector<Event> events) {
    auto kept = std::make_unique<std::vector<Event>>(std::move(events));
    const auto size = py::ssize_t(kept->size());
    const Event* const data = kept->data();
    const py::capsule owner(kept.release(),
                            [](void* it) { delete static_cast<std::vector<Event>*>(it); });
    return {event_dtype(), {size}, {py::ssize_t(sizeof(Event))}, data, owner};
}

py::array_t<float> array_of(const Array2<float>& plane, py::handle owner) {
    return py::array_t<float>({plane.height(), plane.width()}, plane.values().data(), owner);
}

py::array_t<float> array_of(Array2<float> plane) {
    auto owned = std::make_unique<Array2<float>>(std::move(plane));
    const py::capsule owner(owned.get(), [](void* it) { delete static_cast<Array2<float>*>(it); });
    return array_of(*owned.release(), owner);
}

Array2<float> plane_of(const py::array& array, const char* what) {
    refuse_mask(array, what);
    if (array.ndim() != 2)
        throw Error(ErrorKind::usage, std::string{what} + ": expected an array [y, x], found " +
                                          std::to_string(array.ndim()) + " dimensions");
    const char kind = array.dtype().kind();
    if (kind != 'f' && kind != 'b')
        throw Error(ErrorKind::usage, std::string{what} +
                                          ": expected floats, 0 black to 1 white, found " +
                                          std::string(py::str(array.dtype())));
    const Plain<float> values(array);
    Array2<float> plane(int(values.shape(0)), int(values.shape(1)));
    std::copy_n(values.data(), plane.values().size(), plane.values().begin());
    return plane;
}

py::array array_of(const ReferenceImage& image) {
    const int height = image.pixels.height(), channels = std::max(image.channels, 1);
    const int width = image.pixels.width() / channels;
    std::vector<py::ssize_t> shape{height, width};
    if (channels > 1) shape.push_back(channels);
    return py::array_t<std::uint16_t>(shape, image.pixels.values().data());
}

ReferenceImage image_of(const py::array& array) {
    refuse_mask(array, "image");
    const char kind = array.dtype().kind();
    const auto size = array.dtype().itemsize();
    const auto is_side = [&](int axis) {
        return array.shape(axis) >= 1 && array.shape(axis) <= kLargestSensorSide;
    };
    const py::ssize_t channels = array.ndim() == 3 ? array.shape(2) : 1;
    const bool is_colour = array.ndim() == 3 && (channels == 3 || channels == 4);
    if (kind != 'u' || size > 2 || !(array.ndim() == 2 || is_colour) || !is_side(0) || !is_side(1))
        throw Error(ErrorKind::usage,
                    "image: expected uint8 or uint16 [y, x], [y, x, 3] or [y, x, 4] of 1 to " +
                        std::to_string(kLargestSensorSide) + " px each way, found " +
                        std::string(py::str(array.dtype())) + " of shape " +
                        std::string(py::str(array.attr("shape"))));
    const Plain<std::uint16_t> values(array);
    ReferenceImage image;
    image.channels = int(channels);
    image.pixels = {int(array.shape(0)), int(array.shape(1)) * image.channels};
    const unsigned scale = size == 1 ? 257 : 1;
    std::ranges::transform(values.data(), values.data() + values.size(),
                           image.pixels.values().begin(),
                           [scale](unsigned v) { return std::uint16_t(scale * v); });
    return image;
}

}  // namespace eventide::python
