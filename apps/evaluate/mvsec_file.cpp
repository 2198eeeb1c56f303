// MVSEC through the HDF5 library, a part of each data set at a time.
#include "apps/evaluate/mvsec_file.h"

#include "apps/evaluate/rows.h"
#include "apps/evaluate/seconds.h"
#include "src/core/error.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <functional>
#include <mutex>
#include <numeric>
#include <ranges>
#include <utility>

namespace eventide {
namespace {

namespace fs = std::filesystem;

constexpr hsize_t kRowsAtATime = 1 << 18;
// Of an image's time and its last event's: EVREAL's tolerance.
constexpr double kIndexTolerance_s = 1e-3;
constexpr double kMaxInflation = 1032;  // of deflate: 258 bytes from 2 bits

/// Something of HDF5's that wants to be closed.
class Handle {
public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Handle& operator=(Handle&&) = delete;
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    hid_t id() const { return id_; }
    bool good() const { return id_ >= 0; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

[[noreturn]] void refuse(const std::string& what) {
    throw Error(ErrorKind::input, what);
}

std::string shape_text(const std::vector<hsize_t>& shape) {
    std::string text = "[";
    for (const hsize_t n : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(n);
    return text + "]";
}

/// One array of the file, of `rank` dimensions; rows are its first.
class DataSet {
public:
    DataSet(const Handle& file, const fs::path& path, const std::string& name, std::size_t rank,
            const std::string& expected)
        : name_(path.string() + ": davis/left/" + name),
          set_(H5Dopen2(file.id(), ("davis/left/" + name).c_str(), H5P_DEFAULT), H5Dclose),
          space_(set_.good() ? H5Dget_space(set_.id()) : -1, H5Sclose) {
        if (!space_.good()) refuse(name_ + ": expected " + expected + ", found no such data set");
        shape_.resize(std::size_t(std::max(0, H5Sget_simple_extent_ndims(space_.id()))));
        H5Sget_simple_extent_dims(space_.id(), shape_.data(), nullptr);
        if (shape_.size() != rank)
            refuse(name_ + ": expected " + expected + ", found " + shape_text(shape_));
        check_stored();
    }

    hsize_t rows() const { return shape_[0]; }
    hsize_t size(std::size_t dimension) const { return shape_[dimension]; }
    const std::string& name() const { return name_; }

    /// Rows [first, first + count), as numbers of the given kind.
    template <typename T>
    std::vector<T> read(hsize_t first, hsize_t count, hid_t kind) const {
        std::vector<hsize_t> start(shape_.size(), 0), part = shape_;
        start[0] = first;
        part[0] = count;
        hsize_t numbers = 1;
        for (const hsize_t n : part) numbers *= n;
        std::vector<T> values(static_cast<std::size_t>(numbers));
        const Handle memory{H5Screate_simple(int(part.size()), part.data(), nullptr), H5Sclose};
        if (H5Sselect_hyperslab(space_.id(), H5S_SELECT_SET, start.data(), nullptr, part.data(),
                                nullptr) < 0 ||
            H5Dread(set_.id(), kind, memory.id(), space_.id(), H5P_DEFAULT, values.data()) < 0)
            refuse(name_ + ": expected rows " + std::to_string(first) + " to " +
                   std::to_string(first + count) + ", found none that can be read");
        return values;
    }

private:
    /// A shape costs nothing to write: HDF5 makes up what the file does not hold.
    void check_stored() const {
        const Handle kind{H5Dget_type(set_.id()), H5Tclose};
        const double needed = std::accumulate(shape_.begin(), shape_.end(),
                                              double(H5Tget_size(kind.id())), std::multiplies{});
        const hsize_t stored = H5Dget_storage_size(set_.id());
        if (needed > double(stored) * kMaxInflation)
            refuse(name_ + ": expected the data of " + shape_text(shape_) + " numbers, found " +
                   std::to_string(stored) + " bytes");
    }

    std::string name_;
    Handle set_, space_;
    std::vector<hsize_t> shape_;
};

/// The left camera, and the time that times are told from.
struct LeftCamera {
    DataSet events, images, image_times, image_events;
    double first_s = 0;

    LeftCamera(const Handle& file, const fs::path& path)
        : events(file, path, "events", 2, "[event][x y t p]"),
          images(file, path, "image_raw", 3, "[image][y][x]"),
          image_times(file, path, "image_raw_ts", 1, "a time per image"),
          image_events(file, path, "image_raw_event_inds", 1, "an event per image") {
        if (events.size(1) != 4)
            refuse(events.name() + ": expected 4 numbers per event, found " +
                   std::to_string(events.size(1)));
        check_sensor_size(images.name(), std::int64_t(images.size(2)),
                          std::int64_t(images.size(1)));
        for (const DataSet* other : {&image_times, &image_events})
            if (other->rows() != images.rows())
                refuse(other->name() + ": expected " + std::to_string(images.rows()) +
                       " rows, one per image, found " + std::to_string(other->rows()));
        if (events.rows() == 0 || images.rows() == 0)
            refuse(path.string() + ": expected events and images, found " +
                   std::to_string(events.rows()) + " and " + std::to_string(images.rows()));
        first_s = std::min(event_time(0), image_times.read<double>(0, 1, H5T_NATIVE_DOUBLE)[0]);
    }

    double event_time(hsize_t row) const {
        return events.read<double>(row, 1, H5T_NATIVE_DOUBLE)[2];
    }
    /// From the first event or image. Subtracted before it is rounded: times are those of 2017.
    SensorTime time_of(double seconds) const {
        if (const auto t = time_from_seconds(seconds - first_s)) return *t;
        refuse(events.name() + ": expected times in seconds, found " + std::to_string(seconds));
    }
    /// The first event that is not before `t`.
    hsize_t first_event_at(SensorTime t) const {
        return partition_row(events.rows(),
                             [&](hsize_t row) { return time_of(event_time(row)) < t; });
    }
};

/// Both ends included.
struct Span {
    SensorTime from, to;
};

void read_events(const LeftCamera& camera, const Span& span, ReferenceSequence& into) {
    const hsize_t begin = camera.first_event_at(span.from),
                  end = camera.first_event_at(span.to + SensorDuration{1});
    for (hsize_t row = begin; row < end; row += kRowsAtATime) {
        const auto numbers =
            camera.events.read<double>(row, std::min(kRowsAtATime, end - row), H5T_NATIVE_DOUBLE);
        for (std::size_t i = 0; i < numbers.size(); i += 4) {
            const double x = numbers[i], y = numbers[i + 1];
            if (!(x >= 0 && y >= 0 && x < into.width && y < into.height)) continue;
            into.events.push_back({camera.time_of(numbers[i + 2]), std::uint16_t(x),
                                   std::uint16_t(y),
                                   numbers[i + 3] > 0 ? Polarity::on : Polarity::off});
        }
    }
}

/// The index of an image's last event says the same as the times do. An image before the first
/// event has -1; where nothing happens, that event is older than the image.
void check_index(const LeftCamera& camera, std::int64_t index, double image_s, std::size_t image) {
    const auto rows = std::int64_t(camera.events.rows());
    const auto time = [&](std::int64_t row) { return camera.event_time(hsize_t(row)); };
    if (index < -1 || index >= rows)
        refuse(camera.image_events.name() + ", image " + std::to_string(image) +
               ": expected an event of " + std::to_string(rows) + ", found " +
               std::to_string(index));
    const bool late = index >= 0 && time(index) > image_s + kIndexTolerance_s;
    const bool early = index + 1 < rows && time(index + 1) < image_s - kIndexTolerance_s;
    if (late || early)
        refuse(camera.image_events.name() + ", image " + std::to_string(image) +
               ": expected its last event, found one that is " + (late ? "later" : "followed") +
               (late ? " by more than 1 ms" : " by others more than 1 ms before the image"));
}

void read_images(const LeftCamera& camera, const Span& span, ReferenceSequence& into) {
    const auto times = camera.image_times.read<double>(0, camera.images.rows(), H5T_NATIVE_DOUBLE);
    const auto indices =
        camera.image_events.read<std::int64_t>(0, camera.images.rows(), H5T_NATIVE_INT64);
    for (std::size_t i = 0; i < times.size(); ++i) {
        const SensorTime t = camera.time_of(times[i]);
        if (t < span.from || t > span.to) continue;
        check_index(camera, indices[i], times[i], i);
        ReferenceImage image;
        image.t = image.exposure_begin = image.exposure_end = t;
        image.pixels = Array2<std::uint16_t>(into.height, into.width);
        const auto grey = camera.images.read<std::uint8_t>(i, 1, H5T_NATIVE_UINT8);
        std::ranges::transform(grey, image.pixels.values().begin(),
                               [](std::uint8_t v) { return std::uint16_t(257 * v); });
        into.images.push_back(std::move(image));
    }
}

}  // namespace

ReferenceSequence read_mvsec_file(const fs::path& path, std::optional<double> from_s,
                                  std::optional<double> to_s) {
    // Debian's HDF5 is not made for several threads at once.
    static std::mutex one_at_a_time;
    const std::lock_guard lock{one_at_a_time};
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // it would print; what is wrong is thrown
    const Handle file{H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose};
    if (!file.good()) refuse(path.string() + ": expected an HDF5 file, found none");
    const LeftCamera camera{file, path};
    const auto at = [](std::optional<double> s, double otherwise) {
        return time_from_seconds(s.value_or(otherwise))
            .value_or(otherwise < 0 ? SensorTime::min() : SensorTime::max());
    };
    const Span span{at(from_s, -1e12), at(to_s, 1e12)};
    ReferenceSequence sequence;
    sequence.name = path.stem().string();
    sequence.height = int(camera.images.size(1));
    sequence.width = int(camera.images.size(2));
    read_images(camera, span, sequence);
    read_events(camera, span, sequence);
    if (sequence.events.empty() || sequence.images.empty())
        refuse(path.string() + ": expected events and images in the time asked for");
    return sequence;
}

}  // namespace eventide
