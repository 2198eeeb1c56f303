#include "tests/replay/hdf5_layouts.h"

#include "replay/formats.h"
#include "replay/recording_file.h"
#include "tests/replay/hdf5_files.h"

namespace eventide::test {

void write_dsec(const std::string& path, const std::vector<Event>& events) {
    const Columns columns(events, kDsecOffset);
    const Hdf5Made file(path);
    file.column("events/x", columns.x, H5T_STD_U16LE);
    file.column("events/y", columns.y, H5T_STD_U16LE);
    file.column("events/t", columns.t, H5T_STD_U32LE);
    file.column("events/p", columns.p, H5T_STD_U8LE);
    file.column("ms_to_idx", columns.ms_index(), H5T_STD_U64LE);
    file.scalar("t_offset", kDsecOffset);
}

void write_m3ed(const std::string& path, const std::vector<Event>& events) {
    const Columns columns(events);
    const Hdf5Made file(path);
    file.column("prophesee/left/x", columns.x, H5T_STD_U16LE);
    file.column("prophesee/left/y", columns.y, H5T_STD_U16LE);
    file.column("prophesee/left/t", columns.t, H5T_STD_I64LE);
    file.column("prophesee/left/p", columns.p, H5T_STD_I8LE);
    file.column("prophesee/left/ms_map_idx", columns.ms_index(), H5T_STD_U64LE);
    file.column("prophesee/left/calib/resolution", std::vector<std::int64_t>{1280, 720},
                H5T_STD_I64LE);
}

void write_mvsec(const std::string& path, const std::vector<Event>& events) {
    std::vector<double> rows;
    for (const Event& event : events)
        rows.insert(rows.end(), {double(event.x), double(event.y), double(to_us(event.t)) / 1e6,
                                 event.polarity == Polarity::on ? 1. : -1.});
    const Hdf5Made file(path);
    file.array("davis/left/events", {events.size(), 4}, H5T_NATIVE_DOUBLE, rows.data(),
               H5T_IEEE_F64LE, 4096);
}

void write_prophesee(const std::string& path, const std::vector<Event>& events) {
    struct Record {
        std::uint16_t x, y;
        std::int16_t p;
        std::int64_t t;
    };
    std::vector<Record> records;
    for (const Event& event : events)
        records.push_back({event.x, event.y, std::int16_t(event.polarity), to_us(event.t)});
    const hid_t kind = H5Tcreate(H5T_COMPOUND, sizeof(Record));
    H5Tinsert(kind, "x", HOFFSET(Record, x), H5T_NATIVE_UINT16);
    H5Tinsert(kind, "y", HOFFSET(Record, y), H5T_NATIVE_UINT16);
    H5Tinsert(kind, "p", HOFFSET(Record, p), H5T_NATIVE_INT16);
    H5Tinsert(kind, "t", HOFFSET(Record, t), H5T_NATIVE_INT64);
    const Hdf5Made file(path);
    file.text_attribute("geometry", "1280x720");
    file.array("CD/events", {records.size()}, kind, records.data(), kind, 4096);
    H5Tclose(kind);
}

void write_event_utils(const std::string& path, const std::vector<Event>& events) {
    const Columns columns(events);
    const Hdf5Made file(path);
    file.column("events/xs", columns.x, H5T_STD_I16LE);
    file.column("events/ys", columns.y, H5T_STD_I16LE);
    file.column("events/ts", columns.t_s, H5T_IEEE_F64LE);
    file.column("events/ps", columns.p, H5T_STD_I8LE);
    file.attribute("/", "sensor_resolution", std::vector<std::int64_t>{180, 240});
}

void write_e2calib(const std::string& path, const std::vector<Event>& events) {
    const Columns columns(events);
    const Hdf5Made file(path);
    file.column("x", columns.x, H5T_STD_U16LE);
    file.column("y", columns.y, H5T_STD_U16LE);
    file.column("t", columns.t, H5T_STD_I64LE);
    file.column("p", columns.p, H5T_STD_U8LE);
}

void write_hdf5(const std::string& path, const std::vector<Event>& events) {
    StreamHeader header;
    header.width = 640;
    header.height = 480;
    RecordingFile file(path, OutputOptions{.overwrite = true}, *find_format("hdf5"), header);
    Batch batch;
    batch.events = events;
    file.write(batch);
    file.finish();
}
}  // namespace eventide::test
