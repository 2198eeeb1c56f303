// DSEC's layout, a block of events at a time.
#include "replay/hdf5/hdf5_writer.h"

#include "src/core/error.h"
#include "src/core/whole_sensor.h"
#include "src/io/hdf5/hdf5_handle.h"
#include "src/io/hdf5/hdf5_library.h"
#include "src/io/system_words.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

namespace eventide {

namespace {

using Lock = std::lock_guard<std::recursive_mutex>;

constexpr std::size_t kBlockRows = std::size_t{1} << 16;
constexpr std::int64_t kUsPerMs = 1000;
/// Of the sensor: what a killed run may lose of a file that others see.
constexpr std::int64_t kFlushEveryUs = 1'000'000;
/// Of one recording: its index has a number for each.
constexpr std::int64_t kLongestMs = std::int64_t{7} * 24 * 3600 * 1000;

/// A column that grows.
template <typename T>
class Column {
public:
    Column(hid_t file, std::string name, hid_t kind) : name_(std::move(name)), kind_(kind) {
        const Hdf5Library& h5 = hdf5();
        const hsize_t none = 0, any = H5S_UNLIMITED, block = kBlockRows;
        const Hdf5Handle space{h5.H5Screate_simple(1, &none, &any), h5.H5Sclose};
        const Hdf5Handle plan{h5.H5Pcreate(h5.H5P_CLS_DATASET_CREATE_ID_g), h5.H5Pclose};
        h5.H5Pset_chunk(plan.id(), 1, &block);
        h5.H5Pset_shuffle(plan.id());
        h5.H5Pset_deflate(plan.id(), 1);
        set_ = {h5.H5Dcreate2(file, name_.c_str(), kind, space.id(), H5P_DEFAULT, plan.id(),
                              H5P_DEFAULT),
                h5.H5Dclose};
    }
    void add(T value) { pending_.push_back(value); }
    bool is_full() const { return pending_.size() >= kBlockRows; }

    bool flush() {
        if (pending_.empty()) return true;
        const Hdf5Library& h5 = hdf5();
        const hsize_t first = rows_, count = pending_.size();
        rows_ += count;
        const bool grown = h5.H5Dset_extent(set_.id(), &rows_) >= 0;
        const Hdf5Handle file{h5.H5Dget_space(set_.id()), h5.H5Sclose};
        const Hdf5Handle memory{h5.H5Screate_simple(1, &count, nullptr), h5.H5Sclose};
        const bool good = grown &&
                          h5.H5Sselect_hyperslab(file.id(), H5S_SELECT_SET, &first, nullptr, &count,
                                                 nullptr) >= 0 &&
                          h5.H5Dwrite(set_.id(), kind_, memory.id(), file.id(), H5P_DEFAULT,
                                      pending_.data()) >= 0;
        pending_.clear();
        return good;
    }
    bool close() { return flush() && set_.close(); }

private:
    std::string name_;
    hid_t kind_;
    Hdf5Handle set_;
    hsize_t rows_ = 0;
    std::vector<T> pending_;
};

Hdf5Handle make_file(OutputFile& file) {
    const Hdf5Library& h5 = hdf5();
    errno = 0;
    Hdf5Handle made{
        h5.H5Fcreate(file.path_to_reopen().c_str(), kHdf5Replace, H5P_DEFAULT, H5P_DEFAULT),
        h5.H5Fclose};
    if (!made.good())
        throw Error(ErrorKind::failed, file.name() + ": cannot be created: " + system_words(errno));
    return made;
}

Hdf5Handle make_group(hid_t file, const char* name) {
    return {hdf5().H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), hdf5().H5Gclose};
}

bool write_attribute(hid_t object, const char* name, hid_t kind, hsize_t count, const void* value) {
    const Hdf5Library& h5 = hdf5();
    const Hdf5Handle space{
        count == 0 ? h5.H5Screate(H5S_SCALAR) : h5.H5Screate_simple(1, &count, nullptr),
        h5.H5Sclose};
    const Hdf5Handle attribute{
        h5.H5Acreate2(object, name, kind, space.id(), H5P_DEFAULT, H5P_DEFAULT), h5.H5Aclose};
    return attribute.good() && h5.H5Awrite(attribute.id(), kind, value) >= 0;
}

bool write_text(hid_t object, const char* name, const std::string& text) {
    if (text.empty()) return true;
    const Hdf5Library& h5 = hdf5();
    const Hdf5Handle kind{h5.H5Tcopy(h5.H5T_C_S1_g), h5.H5Tclose};
    h5.H5Tset_size(kind.id(), text.size());
    return write_attribute(object, name, kind.id(), 0, text.data());
}

class Hdf5Writer final : public FileWriter {
public:
    Hdf5Writer(OutputFile& file, const StreamHeader& header)
        : name_(file.name()),
          width_(header.width),
          height_(header.height),
          is_shown_(file.is_shown()),
          lock_(hdf5_mutex()),
          file_(make_file(file)),
          events_(make_group(file_.id(), "events")),
          x_(file_.id(), "events/x", hdf5().H5T_NATIVE_UINT16_g),
          y_(file_.id(), "events/y", hdf5().H5T_NATIVE_UINT16_g),
          t_(file_.id(), "events/t", hdf5().H5T_NATIVE_INT64_g),
          p_(file_.id(), "events/p", hdf5().H5T_NATIVE_UINT8_g),
          index_(file_.id(), "ms_to_idx", hdf5().H5T_NATIVE_UINT64_g) {
        const std::int64_t size[] = {header.height, header.width};
        check(write_attribute(file_.id(), "sensor_resolution", hdf5().H5T_NATIVE_INT64_g, 2, size));
        check(write_text(file_.id(), "sensor_name", header.sensor_name));
        check(write_text(file_.id(), "serial_number", header.serial));
        lock_.unlock();
    }

    void write(const Batch& batch) override {
        const Lock lock{hdf5_mutex()};
        auto image = batch.images.begin();
        for (const Event& event : batch.events) {
            for (; image != batch.images.end() && image->t <= event.t; ++image) write(*image);
            write(event);
        }
        for (; image != batch.images.end(); ++image) write(*image);
        if (is_shown_ && newest_us_ - flushed_us_ >= kFlushEveryUs) flush();
    }

    void finish() override {
        const Lock lock{hdf5_mutex()};
        if (!first_us_) write_offset(0);
        check(x_.close() && y_.close() && t_.close() && p_.close() && index_.close());
        check(events_.close() && images_.close() && file_.close());
    }

private:
    void check(bool good) const {
        if (good) return;
        throw Error(ErrorKind::failed,
                    name_ + ": cannot be written" + (errno == 0 ? "" : ": " + system_words(errno)));
    }

    void write(const Event& event) {
        if (!first_us_) write_offset(*(first_us_ = to_us(event.t)));
        const std::int64_t t = to_us(event.t) - *first_us_;
        if (t < 0 || t / kUsPerMs > kLongestMs)
            throw Error(ErrorKind::usage,
                        name_ +
                            ": expected events within seven days, for which DSEC's layout has "
                            "an index, found one " +
                            std::to_string(t) + " us after the first");
        for (; next_ms_ * kUsPerMs <= t; ++next_ms_) {
            index_.add(rows_);
            if (index_.is_full()) check(index_.flush());
        }
        x_.add(event.x);
        y_.add(event.y);
        t_.add(newest_us_ = t);
        p_.add(std::uint8_t(event.polarity));
        ++rows_;
        if (x_.is_full()) check(flush_columns());
    }

    bool flush_columns() { return x_.flush() && y_.flush() && t_.flush() && p_.flush(); }

    /// To where others see it.
    void flush() {
        check(flush_columns() && index_.flush() &&
              hdf5().H5Fflush(file_.id(), H5F_SCOPE_LOCAL) >= 0);
        flushed_us_ = newest_us_;
    }

    void write(const ReferenceImage& image) {
        // A larger one is another camera's, and has no place in the sensor.
        const bool is_larger =
            image.pixels.width() > width_ * image.channels || image.pixels.height() > height_;
        if (!is_larger && !covers_sensor(image, width_, height_))
            return write(on_whole_sensor(image, width_, height_));
        const Hdf5Library& h5 = hdf5();
        if (!images_.good()) images_ = make_group(file_.id(), "images");
        char name[40];
        std::snprintf(name, sizeof name, "images/image%09llu",
                      static_cast<unsigned long long>(image_count_++));
        // Four channels are BGR and one that is of no use to who looks at them.
        const int channels = image.channels == 1 ? 1 : 3;
        const auto height = hsize_t(image.pixels.height()),
                   width = hsize_t(image.pixels.width() / image.channels);
        const hsize_t shape[] = {height, width, 3};
        const Hdf5Handle space{h5.H5Screate_simple(channels == 1 ? 2 : 3, shape, nullptr),
                               h5.H5Sclose};
        std::vector<std::uint16_t> pixels;
        for (std::size_t i = 0; i < image.pixels.values().size(); ++i)
            if (int(i) % image.channels < 3) pixels.push_back(image.pixels.values()[i]);
        const bool narrow =
            std::ranges::all_of(pixels, [](std::uint16_t value) { return value % 257 == 0; });
        if (narrow)
            for (std::uint16_t& value : pixels) value = std::uint16_t(value / 257);
        const Hdf5Handle set{
            h5.H5Dcreate2(file_.id(), name, narrow ? h5.H5T_NATIVE_UINT8_g : h5.H5T_NATIVE_UINT16_g,
                          space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            h5.H5Dclose};
        const double seconds = double(to_us(image.t)) / 1e6;
        const auto event = std::int64_t(rows_ > 0 ? rows_ - 1 : 0);
        check(set.good() &&
              h5.H5Dwrite(set.id(), h5.H5T_NATIVE_UINT16_g, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                          pixels.data()) >= 0 &&
              write_attribute(set.id(), "timestamp", h5.H5T_NATIVE_DOUBLE_g, 0, &seconds) &&
              write_attribute(set.id(), "event_idx", h5.H5T_NATIVE_INT64_g, 0, &event));
    }

    void write_offset(std::int64_t offset) {
        const Hdf5Library& h5 = hdf5();
        const Hdf5Handle space{h5.H5Screate(H5S_SCALAR), h5.H5Sclose};
        const Hdf5Handle set{h5.H5Dcreate2(file_.id(), "t_offset", h5.H5T_NATIVE_INT64_g,
                                           space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                             h5.H5Dclose};
        check(set.good() && h5.H5Dwrite(set.id(), h5.H5T_NATIVE_INT64_g, H5S_ALL, H5S_ALL,
                                        H5P_DEFAULT, &offset) >= 0);
    }

    std::string name_;
    int width_, height_;  // px
    bool is_shown_;
    std::unique_lock<std::recursive_mutex> lock_;  // while the columns are made
    Hdf5Handle file_, events_, images_;
    Column<std::uint16_t> x_, y_;
    Column<std::int64_t> t_;
    Column<std::uint8_t> p_;
    Column<std::uint64_t> index_;
    std::optional<std::int64_t> first_us_;
    std::int64_t newest_us_ = 0, flushed_us_ = 0;  // from the first event on
    std::int64_t next_ms_ = 0;
    std::uint64_t rows_ = 0, image_count_ = 0;
};

}  // namespace

std::unique_ptr<FileWriter> make_hdf5_writer(OutputFile& file, const StreamHeader& header) {
    if (!file.is_seekable())
        throw Error(ErrorKind::usage,
                    file.name() + ": expected a file to write HDF5 to, found a pipe or device");
    return std::make_unique<Hdf5Writer>(file, header);
}

}  // namespace eventide
