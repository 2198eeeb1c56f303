// MVSEC through the HDF5 library, a part of each data set at a time.
#include "apps/evaluate/mvsec_file.h"

#include "apps/evaluate/seconds.h"
#include "src/core/error.h"
#include "src/core/partition_row.h"
#include "src/io/hdf5_file.h"

#include <algorithm>
#include <ranges>
#include <utility>

namespace eventide {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kRowsAtATime = 1 << 18;
// Of an image's time and its last event's: EVREAL's tolerance.
constexpr double kIndexTolerance_s = 1e-3;

[[noreturn]] void refuse(const std::string& what) {
    throw Error(ErrorKind::input, what);
}

/// One array of the file, of `rank` dimensions; rows are its first.
class DataSet {
public:
    DataSet(const Hdf5File& file, const std::string& name, std::size_t rank,
            const std::string& expected)
        : data_(open(file, "davis/left/" + name, expected)) {
        if (data_.shape().size() != rank) data_.refuse(expected, data_.shape_text());
    }

    std::uint64_t rows() const { return data_.rows(); }
    std::uint64_t size(std::size_t dimension) const { return data_.shape()[dimension]; }
    const std::string& name() const { return data_.name(); }

    /// Rows [first, first + count).
    template <typename T>
    std::vector<T> read(std::uint64_t first, std::uint64_t count) const {
        std::vector<T> values(static_cast<std::size_t>(count * data_.row_length()));
        if (!data_.read<T>(first, values))
            data_.refuse("rows " + std::to_string(first) + " to " + std::to_string(first + count),
                         "none that can be read");
        return values;
    }

private:
    static Hdf5Data open(const Hdf5File& file, const std::string& name,
                         const std::string& expected) {
        if (file.has(name)) return file.data(name);
        refuse(file.path() + ": " + name + ": expected " + expected + ", found no such data set");
    }
    Hdf5Data data_;
};

/// The left camera, and the time that times are told from.
struct LeftCamera {
    DataSet events, images, image_times, image_events;
    double first_s = 0;

    LeftCamera(const Hdf5File& file, const fs::path& path)
        : events(file, "events", 2, "[event][x y t p]"),
          images(file, "image_raw", 3, "[image][y][x]"),
          image_times(file, "image_raw_ts", 1, "a time per image"),
          image_events(file, "image_raw_event_inds", 1, "an event per image") {
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
        first_s = std::min(event_time(0), image_times.read<double>(0, 1)[0]);
    }

    double event_time(std::uint64_t row) const { return events.read<double>(row, 1)[2]; }
    /// From the first event or image. Subtracted before it is rounded: times are those of 2017.
    SensorTime time_of(double seconds) const {
        if (const auto t = time_from_seconds(seconds - first_s)) return *t;
        refuse(events.name() + ": expected times in seconds, found " + std::to_string(seconds));
    }
    /// The first event that is not before `t`.
    std::uint64_t first_event_at(SensorTime t) const {
        return partition_row(events.rows(),
                             [&](std::uint64_t row) { return time_of(event_time(row)) < t; });
    }
};

/// Both ends included.
struct Span {
    SensorTime from, to;
};

void read_events(const LeftCamera& camera, const Span& span, ReferenceSequence& into) {
    const std::uint64_t begin = camera.first_event_at(span.from),
                        end = camera.first_event_at(span.to + SensorDuration{1});
    for (std::uint64_t row = begin; row < end; row += kRowsAtATime) {
        const auto numbers = camera.events.read<double>(row, std::min(kRowsAtATime, end - row));
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
    const auto time = [&](std::int64_t row) { return camera.event_time(std::uint64_t(row)); };
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
    const auto times = camera.image_times.read<double>(0, camera.images.rows());
    const auto indices = camera.image_events.read<std::int64_t>(0, camera.images.rows());
    for (std::size_t i = 0; i < times.size(); ++i) {
        const SensorTime t = camera.time_of(times[i]);
        if (t < span.from || t > span.to) continue;
        check_index(camera, indices[i], times[i], i);
        ReferenceImage image;
        image.t = image.exposure_begin = image.exposure_end = t;
        image.pixels = Array2<std::uint16_t>(into.height, into.width);
        const auto grey = camera.images.read<std::uint8_t>(i, 1);
        std::ranges::transform(grey, image.pixels.values().begin(),
                               [](std::uint8_t v) { return std::uint16_t(257 * v); });
        into.images.push_back(std::move(image));
    }
}

}  // namespace

ReferenceSequence read_mvsec_file(const fs::path& path, std::optional<double> from_s,
                                  std::optional<double> to_s) {
    const Hdf5File file{path.string()};
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
