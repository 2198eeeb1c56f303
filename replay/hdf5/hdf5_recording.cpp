// Which layout a file has, and what it says of the sensor.
#include "replay/hdf5/hdf5_recording.h"

#include "replay/hdf5/hdf5_tables.h"
#include "replay/table_reader.h"
#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"
#include "src/core/whole_sensor.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace eventide {

namespace {

/// Keeps the file open for the tables that read it.
class Hdf5Reader final : public DataReader {
public:
    Hdf5Reader(std::unique_ptr<Hdf5File> file, std::unique_ptr<TableReader> table,
               std::vector<std::string> remarks)
        : file_(std::move(file)), table_(std::move(table)), remarks_(std::move(remarks)) {
        std::ranges::copy(table_->remarks(), std::back_inserter(remarks_));
    }
    const StreamHeader& header() const override { return table_->header(); }
    bool read(Batch& into, Damage& damage) override { return table_->read(into, damage); }
    void seek(SensorTime t) override { table_->seek(t); }
    double progress() const override { return table_->progress(); }
    std::vector<std::string> remarks() const override { return remarks_; }

private:
    std::unique_ptr<Hdf5File> file_;
    std::unique_ptr<TableReader> table_;
    std::vector<std::string> remarks_;
};

struct Layout {
    StreamHeader header;
    std::unique_ptr<EventTable> events;
    std::unique_ptr<ImageTable> images;
    std::vector<std::string> remarks{};
};

[[noreturn]] void refuse_stream(const Hdf5File& file, const std::string& wanted,
                                const std::vector<std::string>& found) {
    throw Error(ErrorKind::usage, file.path() + ": expected the events of '" + wanted +
                                      "', found those of " + list_of(found));
}

/// A layout for the events of two cameras, "davis/left" and "davis/right".
struct Pair {
    std::string cameras;  ///< "davis"
    std::string told_by;  ///< what there is of a camera with events
};

/// The one wanted, or the left one where both are there; a remark names the other one.
std::string choose_camera(const Hdf5File& file, const Pair& pair, const std::string& wanted,
                          std::vector<std::string>& remarks) {
    std::vector<std::string> found;
    for (const char* side : {"/left", "/right"})
        if (const std::string camera = pair.cameras + side; file.has(camera + pair.told_by))
            found.push_back(camera);
    if (!wanted.empty() && std::ranges::find(found, wanted) == found.end())
        refuse_stream(file, wanted, found);
    std::string chosen = wanted.empty() ? found.front() : wanted;
    for (const std::string& camera : found)
        if (camera != chosen) remarks.push_back(left_out_stream(camera, chosen, camera));
    return chosen;
}

bool is_side(double side) {
    return side >= 1 && side <= kLargestRecordedSide && side == double(int(side));
}

void set_size(StreamHeader& header, double width, double height) {
    if (header.width > 0 || !is_side(width) || !is_side(height)) return;
    header.width = int(width);
    header.height = int(height);
}

/// sensor_resolution, height first (event_utils), or geometry, "640x480" (Prophesee).
void read_size(const Hdf5File& file, StreamHeader& header) {
    if (const auto size = file.number_attributes("/", "sensor_resolution"); size.size() >= 2)
        set_size(header, size[1], size[0]);
    const std::string text = file.text_attribute("/", "geometry");
    if (const auto size = size_in(text)) set_size(header, size->first, size->second);
}

void read_size(const Hdf5Data& resolution, StreamHeader& header) {
    if (resolution.shape().size() != 1 || resolution.rows() < 2) return;
    const auto width = resolution.number<double>(0), height = resolution.number<double>(1);
    if (width && height) set_size(header, *width, *height);
}

std::int64_t offset_of(const Hdf5File& file) {
    if (!file.has("t_offset")) return 0;
    const Hdf5Data data = file.data("t_offset");
    const auto offset = data.row_length() == 1 ? data.number<std::int64_t>(0) : std::nullopt;
    if (offset) return *offset;
    data.refuse("microseconds", "no number");
}

Layout open_mvsec(const Hdf5File& file, const std::string& stream) {
    Layout layout;
    layout.header.sensor_name = "DAVIS346";
    const std::string camera =
        choose_camera(file, {"davis", "/events"}, stream, layout.remarks) + "/";
    layout.events = open_hdf5_matrix(file, camera + "events");
    if (const std::string images = camera + "image_raw"; file.has(images)) {
        layout.images = open_hdf5_stack(file, images, images + "_ts");
        const Hdf5Size size = size_of_images(file.data(images), 1);
        set_size(layout.header, size.width, size.height);
    }
    set_size(layout.header, 346, 260);
    return layout;
}

Layout open_m3ed(const Hdf5File& file, const std::string& stream) {
    Layout layout;
    const std::string camera =
        choose_camera(file, {"prophesee", "/t"}, stream, layout.remarks) + "/";
    layout.events = open_hdf5_columns(
        file, {camera + "x", camera + "y", camera + "t", camera + "p", "", camera + "ms_map_idx"});
    if (const std::string name = camera + "calib/resolution"; file.has(name))
        read_size(file.data(name), layout.header);
    return layout;
}

Layout open_dsec(const Hdf5File& file, const std::string&) {
    Layout layout;
    const std::string index = file.has("ms_to_idx") ? "ms_to_idx" : "events/ms_to_idx";
    layout.events = open_hdf5_columns(
        file, {"events/x", "events/y", "events/t", "events/p", "", index, offset_of(file)});
    layout.images = open_hdf5_images(file, "images");
    return layout;
}

Layout open_event_utils(const Hdf5File& file, const std::string&) {
    Layout layout;
    layout.events =
        open_hdf5_columns(file, {"events/xs", "events/ys", "events/ts", "events/ps", "", "", 0});
    layout.images = open_hdf5_images(file, "images");
    return layout;
}

Layout open_prophesee(const Hdf5File& file, const std::string&) {
    Layout layout;
    layout.events = open_hdf5_columns(file, {"x", "y", "t", "p", "CD/events", "", 0});
    return layout;
}

Layout open_e2calib(const Hdf5File& file, const std::string&) {
    Layout layout;
    layout.events = open_hdf5_columns(file, {"x", "y", "t", "p", "", "", 0});
    return layout;
}

struct KnownLayout {
    const char* told_by;
    Layout (*open)(const Hdf5File&, const std::string& stream);
    bool has_pair = false;  ///< may hold the events of two cameras
};

/// In the order in which they are tried.
constexpr KnownLayout kLayouts[]{
    {"davis/left/events", open_mvsec, true},
    {"davis/right/events", open_mvsec, true},
    {"prophesee/left/t", open_m3ed, true},
    {"prophesee/right/t", open_m3ed, true},
    {"CD/events", open_prophesee},
    {"events/xs", open_event_utils},
    {"events/x", open_dsec},
    {"x", open_e2calib},
};

Layout open_layout(const Hdf5File& file, const std::string& stream) {
    for (const KnownLayout& layout : kLayouts) {
        if (!file.has(layout.told_by)) continue;
        if (!stream.empty() && !layout.has_pair) refuse_stream(file, stream, {layout.told_by});
        return layout.open(file, stream);
    }
    const auto found = file.names_in("/");
    throw Error(ErrorKind::input, file.path() + ": expected events in a layout that is known (" +
                                      list_of(kLayouts, &KnownLayout::told_by) + "), found " +
                                      (found.empty() ? "none" : list_of(found)));
}

/// The size of the images is the sensor's where nothing else states it. Where something does,
/// images of another size are another camera's: nothing says where their pixels lie.
void compare_images(const OpenOptions& options, Layout& layout) {
    const auto image = layout.images ? layout.images->read(0) : std::nullopt;
    if (!image) return;
    const int width = image->pixels.width() / image->channels, height = image->pixels.height();
    set_size(layout.header, width, height);
    const bool is_stated = options.width > 0;
    const int sensor_width = is_stated ? options.width : layout.header.width,
              sensor_height = is_stated ? options.height : layout.header.height;
    if (covers_sensor(*image, sensor_width, sensor_height)) return;
    layout.images.reset();
    layout.remarks.push_back("the images are left out: they are " + size_text(width, height) +
                             " px, the events' sensor has " +
                             size_text(sensor_width, sensor_height));
}

}  // namespace

std::unique_ptr<DataReader> open_hdf5(const std::string& path, const OpenOptions& options) {
    auto file = std::make_unique<Hdf5File>(path);
    Layout layout = open_layout(*file, options.stream);
    layout.header.format = "hdf5";
    if (layout.header.sensor_name.empty())
        layout.header.sensor_name = file->text_attribute("/", "sensor_name");
    layout.header.serial = file->text_attribute("/", "serial_number");
    read_size(*file, layout.header);
    compare_images(options, layout);
    auto table =
        std::make_unique<TableReader>(path, std::move(layout.header), std::move(layout.events),
                                      std::move(layout.images), options);
    return std::make_unique<Hdf5Reader>(std::move(file), std::move(table),
                                        std::move(layout.remarks));
}

}  // namespace eventide
