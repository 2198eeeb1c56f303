// The layouts in which ECD, MVSEC and HQF are found.
#include "apps/evaluate/evreal_sequence.h"

#include "apps/evaluate/seconds.h"
#include "replay/numpy/numpy_file.h"
#include "src/core/error.h"
#include "src/core/partition_row.h"

#include <algorithm>
#include <array>
#include <ranges>
#include <utility>

namespace eventide {
namespace {

namespace fs = std::filesystem;

bool is_npy_folder(const fs::path& path) {
    return fs::exists(path / "events_ts.npy");
}

bool is_sequence(const fs::path& path) {
    if (fs::is_directory(path))
        return is_npy_folder(path) ||
               (fs::exists(path / "events.txt") && fs::exists(path / "images.txt"));
    constexpr std::array kExtensions{".hdf5", ".h5", ".bag", ".aedat4"};
    return std::ranges::find(kExtensions, path.extension()) != kExtensions.end();
}

/// Of an array of times.
SensorTime time_of(double seconds, const NumpyFile& file, std::uint64_t row) {
    if (const auto t = time_from_seconds(seconds)) return *t;
    throw Error(ErrorKind::input, file.name() + ": row " + std::to_string(row) +
                                      ": expected a time in seconds, found " +
                                      std::to_string(seconds));
}

/// The first row of ascending times in seconds that is not before `t`.
std::uint64_t lower_bound_row(NumpyFile& file, SensorTime t) {
    return partition_row(file.rows(), [&](std::uint64_t row) {
        return time_of(file.read(row, 1)[0], file, row) < t;
    });
}

/// Events are found by bisection and cut by their times: only in order does that mean anything.
void check_order(const NumpyFile& file, std::uint64_t row, SensorTime before, SensorTime t) {
    if (t >= before) return;
    throw Error(ErrorKind::input, file.name() + ": row " + std::to_string(row) +
                                      ": expected a time not before the row above, found " +
                                      std::to_string(to_us(t)) + " us after " +
                                      std::to_string(to_us(before)) + " us");
}

/// Both ends included.
struct Span {
    SensorTime from, to;
};

void read_events(const fs::path& folder, const Span& span, ReferenceSequence& into) {
    NumpyFile ts{folder / "events_ts.npy"}, xy{folder / "events_xy.npy"},
        p{folder / "events_p.npy"};
    const bool fit = xy.rows() == ts.rows() && p.rows() == ts.rows();
    if (!fit ||
        (ts.rows() > 0 && (xy.row_length() != 2 || ts.row_length() != 1 || p.row_length() != 1)))
        throw Error(ErrorKind::input, folder.string() +
                                          ": expected events_ts, events_xy and events_p of as many "
                                          "rows (of 1, 2 and 1 numbers), found " +
                                          std::to_string(ts.rows()) + ", " +
                                          std::to_string(xy.rows()) + " and " +
                                          std::to_string(p.rows()));
    if (ts.rows() == 0) throw Error(ErrorKind::input, ts.name() + ": expected events, found none");
    const std::uint64_t begin = lower_bound_row(ts, span.from),
                        end = lower_bound_row(ts, span.to + SensorDuration{1});
    SensorTime newest = SensorTime::min();
    constexpr std::uint64_t kAtATime = 1 << 20;
    for (std::uint64_t row = begin; row < end; row += kAtATime) {
        const std::uint64_t n = std::min(kAtATime, end - row);
        const auto t = ts.read(row, n), place = xy.read(row, n), polarity = p.read(row, n);
        for (std::size_t i = 0; i < n; ++i) {
            const SensorTime before = std::exchange(newest, time_of(t[i], ts, row + i));
            check_order(ts, row + i, before, newest);
            const double x = place[2 * i], y = place[2 * i + 1];
            if (!(x >= 0 && y >= 0 && x < into.width && y < into.height)) continue;
            into.events.push_back({newest, std::uint16_t(x), std::uint16_t(y),
                                   polarity[i] > 0 ? Polarity::on : Polarity::off});
        }
    }
}

void read_images(const fs::path& folder, const Span& span, ReferenceSequence& into) {
    NumpyFile images{folder / "images.npy"}, ts{folder / "images_ts.npy"};
    const std::vector<std::uint64_t>& shape = images.array().shape;
    const bool grey = shape.size() == 3 || (shape.size() == 4 && shape[3] == 1);
    if (!grey || images.number().kind != 'u' || images.number().bytes != 1 ||
        ts.rows() != images.rows() || (ts.rows() > 0 && ts.row_length() != 1))
        throw Error(ErrorKind::input,
                    folder.string() +
                        ": expected images.npy [image][y][x] of 8 bit and as many "
                        "times in images_ts.npy");
    check_sensor_size(images.name(), std::int64_t(shape[2]), std::int64_t(shape[1]));
    into.height = int(shape[1]);
    into.width = int(shape[2]);
    if (ts.rows() == 0) throw Error(ErrorKind::input, ts.name() + ": expected images, found none");
    const auto times = ts.read(0, ts.rows());
    for (std::size_t i = 0; i < times.size(); ++i) {
        const SensorTime t = time_of(times[i], ts, i);
        if (t < span.from || t > span.to) continue;
        ReferenceImage image;
        image.t = image.exposure_begin = image.exposure_end = t;
        image.pixels = Array2<std::uint16_t>(into.height, into.width);
        const auto values = images.read(i, 1);
        for (std::size_t k = 0; k < values.size(); ++k)
            image.pixels.values()[k] = std::uint16_t(257 * int(values[k]));
        into.images.push_back(std::move(image));
    }
}

}  // namespace

std::vector<fs::path> evreal_sequences(const fs::path& dataset) {
    if (!fs::exists(dataset))
        throw Error(ErrorKind::input, dataset.string() + ": no such file or folder");
    if (is_sequence(dataset)) return {dataset};
    std::vector<fs::path> found;
    if (fs::is_directory(dataset))
        for (const fs::directory_entry& entry : fs::directory_iterator{dataset})
            if (is_sequence(entry.path())) found.push_back(entry.path());
    std::ranges::sort(found);
    if (found.empty())
        throw Error(ErrorKind::input,
                    dataset.string() +
                        ": expected sequences: folders with events.txt and images.txt (ECD), "
                        "folders with events_ts.npy (EVREAL's arrays), MVSEC's .hdf5 or HQF's .bag "
                        "files; found none of them");
    return found;
}

ReferenceSequence read_evreal_sequence(const fs::path& path, std::optional<double> from_s,
                                       std::optional<double> to_s) {
    if (!is_npy_folder(path)) return read_reference_sequence(path, from_s, to_s);
    // EVREAL's tools have already moved the first event or image to 0.
    const Span span{time_from_seconds(from_s.value_or(-1e12)).value_or(SensorTime::min()),
                    time_from_seconds(to_s.value_or(1e12)).value_or(SensorTime::max())};
    ReferenceSequence sequence;
    sequence.name = sequence_name(path);
    read_images(path, span, sequence);
    mend_times(sequence.images);
    read_events(path, span, sequence);
    return sequence;
}

}  // namespace eventide
