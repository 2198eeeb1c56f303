// HDF5 recordings: each layout gives back the events that were written into it.
#include "replay/convert.h"
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "src/simulate/sim_recording.h"
#include "tests/replay/hdf5_files.h"
#include "tests/replay/recording_files.h"

#include <gmock/gmock.h>

namespace eventide {
namespace {

using test::Columns;
using test::Hdf5Made;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kOffset = 49'599'523;  // us

void write_dsec(const std::string& path, const std::vector<Event>& events) {
    const Columns columns(events, kOffset);
    const Hdf5Made file(path);
    file.column("events/x", columns.x, H5T_STD_U16LE);
    file.column("events/y", columns.y, H5T_STD_U16LE);
    file.column("events/t", columns.t, H5T_STD_U32LE);
    file.column("events/p", columns.p, H5T_STD_U8LE);
    file.column("ms_to_idx", columns.ms_index(), H5T_STD_U64LE);
    file.scalar("t_offset", kOffset);
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

/// What eventide itself writes.
void write_own(const std::string& path, const std::vector<Event>& events) {
    StreamHeader header;
    header.width = 640;
    header.height = 480;
    RecordingFile file(path, true, *find_format("hdf5"), header);
    Batch batch;
    batch.events = events;
    file.write(batch);
    file.finish();
}

struct Layout {
    const char* name;
    void (*write)(const std::string&, const std::vector<Event>&);
    int width, height;
};

class Hdf5Layouts : public testing::TestWithParam<Layout> {
protected:
    const TestFolder folder_;
    const std::vector<Event> events_ = some_events(50'000, kOffset + 700, 20, 240, 180);
    std::string path() const {
        GetParam().write(folder_.path("a.h5"), events_);
        return folder_.path("a.h5");
    }
};

INSTANTIATE_TEST_SUITE_P(All, Hdf5Layouts,
                         testing::Values(Layout{"DSEC", write_dsec, 240, 180},
                                         Layout{"M3ED", write_m3ed, 1280, 720},
                                         Layout{"MVSEC", write_mvsec, 346, 260},
                                         Layout{"Prophesee", write_prophesee, 1280, 720},
                                         Layout{"event_utils", write_event_utils, 240, 180},
                                         Layout{"e2calib", write_e2calib, 240, 180},
                                         Layout{"eventide", write_own, 640, 480}),
                         [](const auto& each) { return std::string(each.param.name); });

TEST_P(Hdf5Layouts, GiveTheEventsThatWereWritten) {
    const auto recording = open_recording(path());
    EXPECT_EQ(recording->info().format, "hdf5");
    EXPECT_EQ(recording->info().width, GetParam().width);
    EXPECT_EQ(recording->info().height, GetParam().height);
    const auto parser = recording->make_parser();
    Batch batch;
    RawPacket packet;
    while (recording->read(packet) == ReadStatus::data) parser->parse(packet.bytes, batch);
    parser->finish(batch);
    EXPECT_TRUE(batch.events == events_);
    EXPECT_EQ(parser->damaged().total(), 0U);
    EXPECT_EQ(recording->position_bytes(), recording->size_bytes());
}

/// Moved to where the layouts' times lie.
std::vector<Event> moved(std::vector<Event> events) {
    const SensorDuration by = from_us(kOffset + 700) - events.front().t;
    for (Event& event : events) event.t += by;
    return events;
}

std::vector<Event> simulated_events() {
    SimRecordingSettings settings;
    settings.scene = simulation_preset("demo").scene;
    settings.sensor = simulation_preset("demo").sensor;
    settings.seconds = .5;
    std::vector<Event> events;
    simulate_recording(settings, procedural_textures(5, 64),
                       [&](const Batch& batch, const std::vector<Truth>&) {
                           events.insert(events.end(), batch.events.begin(), batch.events.end());
                           return true;
                       });
    return moved(events);
}

TEST_P(Hdf5Layouts, GiveTheSimulatorsEvents) {
    const auto events = simulated_events();
    ASSERT_GT(events.size(), 10'000U);
    GetParam().write(folder_.path("s.h5"), events);
    EXPECT_TRUE(read_everything(*open_recording(folder_.path("s.h5"))).events == events);
}

TEST_P(Hdf5Layouts, GiveTheKnownCountsOfRealRecordings) {
    struct Known {
        const char* path;
        std::uint64_t events, on;
    };
    for (const Known& known : {Known{"formats/davis346_robotarm.aedat4", 117'667, 72'363},
                               Known{"formats/davis346_desk.aedat4", 6'676, 3'563},
                               Known{"recordings/slider_depth_head", 50'000, 0}}) {
        const auto path =
            std::filesystem::path(EVENTIDE_SOURCE_DIR) / ".." / "shared" / "data" / known.path;
        if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << known.path << " at hand";
        GetParam().write(folder_.path("r.h5"),
                         moved(read_everything(*open_recording(path.string())).events));
        // Of a DAVIS240's size some layouts say.
        OpenOptions options;
        options.width = 346;
        options.height = 260;
        const Summary sum = summarize(*open_recording(folder_.path("r.h5"), options));
        EXPECT_EQ(sum.events, known.events) << known.path;
        if (known.on > 0) EXPECT_EQ(sum.on, known.on) << known.path;
        EXPECT_EQ(sum.damaged.total(), 0U) << known.path;
    }
}

TEST_P(Hdf5Layouts, SeekThenReadIsReadThenSkip) {
    const auto recording = open_recording(path());
    for (const std::size_t i : {std::size_t{40'000}, std::size_t{0}, std::size_t{25'001}}) {
        const SensorTime t = events_[i].t;
        recording->seek(t);
        EXPECT_GE(recording->position_bytes() + 100,
                  std::uint64_t(double(i) / 50'000 * double(recording->size_bytes())) / 2);
        std::vector<Event> found = read_everything(*recording).events, expected;
        std::erase_if(found, [&](const Event& event) { return event.t < t; });
        for (const Event& event : events_)
            if (event.t >= t) expected.push_back(event);
        EXPECT_TRUE(found == expected) << i;
    }
    recording->seek(events_.back().t + SensorDuration{5'000'000});
    EXPECT_TRUE(read_everything(*recording).events.empty());
}

TEST_P(Hdf5Layouts, AreTheSameByEveryRouteOfBytes) {
    const auto recording = open_recording(path());
    const auto whole = recording->make_parser(), split = recording->make_parser();
    Batch together, apart;
    RawPacket packet;
    while (recording->read(packet) == ReadStatus::data) {
        whole->parse(packet.bytes, together);
        for (std::size_t at = 0; at < packet.bytes.size(); at += 7)
            split->parse(std::span(packet.bytes)
                             .subspan(at, std::min<std::size_t>(7, packet.bytes.size() - at)),
                         apart);
    }
    whole->finish(together);
    split->finish(apart);
    EXPECT_TRUE(together.events == apart.events);
}

std::vector<std::uint8_t> picture(int width, int height, int n) {
    std::vector<std::uint8_t> pixels;
    for (int i = 0; i < width * height; ++i) pixels.push_back(std::uint8_t(i * 7 + n));
    return pixels;
}

void expect_picture(const ReferenceImage& image, int width, int height, int n) {
    ASSERT_EQ(image.pixels.width(), width);
    ASSERT_EQ(image.pixels.height(), height);
    const auto expected = picture(width, height, n);
    for (std::size_t i = 0; i < expected.size(); ++i)
        ASSERT_EQ(image.pixels.values()[i], 257 * expected[i]);
}

TEST(Hdf5Images, OfMvsecComeWithTheEvents) {
    const TestFolder folder;
    const auto events = some_events(20'000, 1'000'000, 20, 346, 260);
    write_mvsec(folder.path("a.hdf5"), events);
    {
        const Hdf5Made file(folder.path("b.hdf5"));
        std::vector<std::uint8_t> pixels;
        for (int n = 0; n < 3; ++n)
            for (const std::uint8_t value : picture(346, 260, n)) pixels.push_back(value);
        file.array("davis/left/image_raw", {3, 260, 346}, H5T_NATIVE_UINT8, pixels.data(),
                   H5T_STD_U8LE);
        file.column("davis/left/image_raw_ts", std::vector<double>{.9, 1.1, 1.15}, H5T_IEEE_F64LE,
                    0);
        const hid_t other = H5Fopen(folder.path("a.hdf5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
        H5Ocopy(other, "davis/left/events", file.id(), "davis/left/events", H5P_DEFAULT,
                H5P_DEFAULT);
        H5Fclose(other);
    }
    const auto recording = open_recording(folder.path("b.hdf5"));
    const Batch batch = read_everything(*recording);
    EXPECT_TRUE(batch.events == events);
    ASSERT_EQ(batch.images.size(), 3U);
    for (int n = 0; n < 3; ++n) expect_picture(batch.images[std::size_t(n)], 346, 260, n);
    EXPECT_EQ(batch.images[1].t, from_us(1'100'000));
    recording->seek(from_us(1'120'000));
    EXPECT_EQ(read_everything(*recording).images.size(), 1U);
}

TEST(Hdf5Images, SurviveTheWayThroughDsecsLayout) {
    const TestFolder folder;
    StreamHeader header;
    header.width = 32;
    header.height = 24;
    header.sensor_name = "DAVIS346";
    header.serial = "00000042";
    Batch batch;
    batch.events = some_events(5'000, 3'000'000, 20, 32, 24);
    for (int n = 0; n < 3; ++n) {
        ReferenceImage image;
        image.t = image.exposure_begin = image.exposure_end =
            batch.events[std::size_t(1'000 * n + 500)].t;
        image.channels = n == 2 ? 3 : 1;
        image.pixels = Array2<std::uint16_t>(24, 32 * image.channels);
        for (std::size_t i = 0; i < image.pixels.values().size(); ++i)
            image.pixels.values()[i] = std::uint16_t(n == 1 ? i * 11 : i % 256 * 257);
        batch.images.push_back(image);
    }
    RecordingFile file(folder.path("a.h5"), false, *find_format("hdf5"), header);
    file.write(batch);
    file.finish();
    EXPECT_EQ(file.bytes_written(), std::filesystem::file_size(folder.path("a.h5")));
    const auto recording = open_recording(folder.path("a.h5"));
    EXPECT_EQ(recording->info().name, "DAVIS346");
    EXPECT_EQ(recording->info().serial, "00000042");
    const Batch back = read_everything(*recording);
    EXPECT_TRUE(back.events == batch.events);
    EXPECT_TRUE(back.images == batch.images);
}

/// What opening says.
std::string refusal(const std::string& path, ErrorKind kind = ErrorKind::input) {
    try {
        read_everything(*open_recording(path));
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    return "nothing was refused";
}

TEST(Hdf5Damage, OfTheFileIsRefusedByName) {
    const TestFolder folder;
    write_dsec(folder.path("a.h5"), some_events(5'000, kOffset));
    const std::string whole = read_text(folder.path("a.h5"));
    EXPECT_THAT(refusal(folder.write("short.h5", whole.substr(0, whole.size() / 2))),
                AllOf(HasSubstr("short.h5"), HasSubstr("cut short")));
    {
        const Hdf5Made other(folder.path("other.h5"));
        other.scalar("poses/first", 3);
    }
    EXPECT_THAT(refusal(folder.path("other.h5")),
                AllOf(HasSubstr("events/x"), HasSubstr("found poses")));
}

TEST(Hdf5Damage, OfColumnsIsRefusedByName) {
    const TestFolder folder;
    const Columns columns(some_events(100));
    {
        const Hdf5Made file(folder.path("a.h5"));
        file.column("events/x", columns.x, H5T_STD_U16LE);
        file.column("events/y", columns.y, H5T_STD_U16LE);
        file.column("events/t", columns.t, H5T_STD_I64LE);
    }
    EXPECT_THAT(refusal(folder.path("a.h5")), HasSubstr("events/p: expected a data set"));
    {
        const Hdf5Made file(folder.path("b.h5"));
        file.column("x", columns.x, H5T_STD_U16LE);
        file.column("y", columns.y, H5T_STD_U16LE);
        file.column("t", columns.t, H5T_STD_I64LE);
        file.column("p", std::vector<std::uint8_t>(99), H5T_STD_U8LE);
    }
    EXPECT_THAT(refusal(folder.path("b.h5")), HasSubstr("as many rows as t, 100, found 99"));
}

TEST(Hdf5Damage, RowsThatTheFileDoesNotHoldAreRefused) {
    const TestFolder folder;
    {
        const Hdf5Made file(folder.path("a.h5"));
        const hsize_t rows = hsize_t{1} << 40;
        const hid_t space = H5Screate_simple(1, &rows, nullptr);
        for (const char* name : {"x", "y", "t", "p"})
            H5Dclose(H5Dcreate2(file.id(), name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT,
                                H5P_DEFAULT));
        H5Sclose(space);
    }
    EXPECT_THAT(refusal(folder.path("a.h5")), HasSubstr("[1099511627776] numbers, found 0 bytes"));
}

TEST(Hdf5Damage, BlocksTooLargeToUnpackAreRefused) {
    const TestFolder folder;
    const Columns columns(some_events(100));
    {
        const Hdf5Made file(folder.path("a.h5"));
        file.column("x", columns.x, H5T_STD_U16LE);
        file.column("y", columns.y, H5T_STD_U16LE);
        file.column("p", columns.p, H5T_STD_U8LE);
        const hsize_t rows = 100, any = H5S_UNLIMITED, block = hsize_t{1} << 28;
        const hid_t space = H5Screate_simple(1, &rows, &any), plan = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_chunk(plan, 1, &block);
        H5Dclose(H5Dcreate2(file.id(), "t", H5T_STD_I64LE, space, H5P_DEFAULT, plan, H5P_DEFAULT));
        H5Pclose(plan);
        H5Sclose(space);
    }
    EXPECT_THAT(refusal(folder.path("a.h5")), HasSubstr("blocks of at most 256 MiB"));
}

std::size_t no_filter(unsigned, std::size_t, const unsigned*, std::size_t bytes, std::size_t*,
                      void**) {
    return bytes;
}

TEST(Hdf5Damage, AMissingPlugInIsNamedWithItsRemedy) {
    const TestFolder folder;
    const Columns columns(some_events(100));
    const struct {
        H5Z_filter_t number;
        const char* remedy;
    } filters[] = {{32001,
                    "blosc (HDF5 filter 32001), whose plug-in the HDF5 library does not "
                    "find; Debian's package is hdf5-filter-plugin-blosc-serial"},
                   {0x8ECF, "github.com/prophesee-ai/hdf5_ecf"},
                   {31999, "an unknown filter (HDF5 filter 31999)"}};
    for (const auto& [number, remedy] : filters) {
        if (H5Zfilter_avail(number) > 0) continue;
        const H5Z_class2_t filter{H5Z_CLASS_T_VERS, number,  1,       1,
                                  "test",           nullptr, nullptr, no_filter};
        H5Zregister(&filter);
        {
            const Hdf5Made file(folder.path("a.h5"));
            const hsize_t rows = 100;
            const hid_t space = H5Screate_simple(1, &rows, nullptr),
                        plan = H5Pcreate(H5P_DATASET_CREATE);
            H5Pset_chunk(plan, 1, &rows);
            H5Pset_filter(plan, number, 0, 0, nullptr);
            for (const char* name : {"events/x", "events/y", "events/t", "events/p"}) {
                const hid_t links = H5Pcreate(H5P_LINK_CREATE);
                H5Pset_create_intermediate_group(links, 1);
                const hid_t set =
                    H5Dcreate2(file.id(), name, H5T_STD_I64LE, space, links, plan, H5P_DEFAULT);
                H5Dwrite(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, columns.t.data());
                H5Dclose(set);
                H5Pclose(links);
            }
            H5Pclose(plan);
            H5Sclose(space);
        }
        H5Zunregister(number);
        EXPECT_THAT(refusal(folder.path("a.h5")), AllOf(HasSubstr("events/x"), HasSubstr(remedy)));
    }
}

TEST(Hdf5Damage, OfABlockCostsTheRowsInItAndIsCounted) {
    const TestFolder folder;
    const auto events = some_events(200'000, kOffset, 20, 240, 180);
    write_dsec(folder.path("a.h5"), events);
    std::string bytes = read_text(folder.path("a.h5"));
    // In the middle lie the packed times.
    for (std::size_t i = 0; i < 40; ++i) bytes[bytes.size() / 2 + i] ^= char(0x5A);
    OpenOptions options;
    options.width = 240;
    options.height = 180;
    const auto recording = open_recording(folder.write("b.h5", bytes), options);
    const Summary sum = summarize(*recording);
    EXPECT_GT(sum.damaged.total(), 0U);
    EXPECT_LT(sum.events, events.size());
    EXPECT_GT(sum.events, events.size() - 40'000);
}

TEST(Hdf5Damage, OfRowsIsCountedByReason) {
    const TestFolder folder;
    const auto events = some_events(1'000, 1'000'000, 20, 100, 100);
    Columns columns(events);
    columns.x[100] = 4000;
    columns.t[200] -= 10'000;
    columns.t[300] = std::int64_t{1} << 62;
    {
        const Hdf5Made file(folder.path("a.h5"));
        file.column("x", columns.x, H5T_STD_U16LE);
        file.column("y", columns.y, H5T_STD_U16LE);
        file.column("t", columns.t, H5T_STD_I64LE);
        file.column("p", columns.p, H5T_STD_U8LE);
    }
    const Summary sum =
        summarize(*open_recording(folder.path("a.h5"), {.width = 128, .height = 128}));
    EXPECT_EQ(sum.damaged[DamageReason::out_of_range], 1U);
    EXPECT_EQ(sum.damaged[DamageReason::time_backwards], 1U);
    EXPECT_EQ(sum.damaged[DamageReason::bad_record], 1U);
    EXPECT_EQ(sum.events, 997U);
}

TEST(Hdf5Damage, OfTheIndexIsCountedAndTheTimeFoundAllTheSame) {
    const TestFolder folder;
    const auto events = some_events(50'000, kOffset, 20, 240, 180);
    Columns columns(events, kOffset);
    auto index = columns.ms_index();
    for (auto& row : index) row = 49'000;  // far behind what it should say
    {
        const Hdf5Made file(folder.path("a.h5"));
        file.column("events/x", columns.x, H5T_STD_U16LE);
        file.column("events/y", columns.y, H5T_STD_U16LE);
        file.column("events/t", columns.t, H5T_STD_U32LE);
        file.column("events/p", columns.p, H5T_STD_U8LE);
        file.column("ms_to_idx", index, H5T_STD_U64LE);
        file.scalar("t_offset", kOffset);
    }
    const auto recording = open_recording(folder.path("a.h5"));
    recording->seek(events[20'000].t);
    const Summary sum = summarize(*recording);
    EXPECT_EQ(sum.damaged[DamageReason::bad_table], 1U);
    EXPECT_EQ(sum.damaged.total(), 1U);
    EXPECT_GE(sum.events, 30'000U);
    EXPECT_LT(sum.events, 30'010U);
}

TEST(Hdf5Writing, KeepsDsecsPromisesOfItsIndex) {
    const TestFolder folder;
    const auto events = some_events(200'000, 7'000'123, 300, 640, 480);
    write_own(folder.path("a.h5"), events);
    const hid_t file = H5Fopen(folder.path("a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const auto read = [&](const char* name) {
        const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
        std::vector<std::int64_t> values(std::size_t(H5Sget_simple_extent_npoints(space)));
        H5Dread(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        H5Sclose(space);
        H5Dclose(set);
        return values;
    };
    const auto t = read("events/t"), index = read("ms_to_idx");
    EXPECT_EQ(read("t_offset"), std::vector<std::int64_t>{to_us(events[0].t)});
    H5Fclose(file);
    ASSERT_EQ(t.size(), events.size());
    ASSERT_EQ(std::int64_t(index.size()), t.back() / 1000 + 1);
    for (std::size_t ms = 0; ms < index.size(); ++ms) {
        const auto row = std::size_t(index[ms]);
        ASSERT_GE(t[row], std::int64_t(ms) * 1000);
        if (row > 0) {
            ASSERT_LT(t[row - 1], std::int64_t(ms) * 1000);
        }
    }
}

TEST(Hdf5Writing, LeavesNothingBehindWhereItFails) {
    const TestFolder folder;
    const std::string precious = folder.write("a.h5", "precious");
    StreamHeader header;
    header.width = header.height = 128;
    EXPECT_THROW(RecordingFile(precious, false, *find_format("hdf5"), header), Error);
    EXPECT_EQ(read_text(precious), "precious");
    {
        RecordingFile file(precious, true, *find_format("hdf5"), header);
        Batch batch;
        batch.events = {{from_us(0), 1, 2, Polarity::on},
                        {from_us(8LL * 86400 * 1'000'000), 1, 2, Polarity::on}};
        EXPECT_THROW(file.write(batch), Error);  // beyond what the index may span
    }
    EXPECT_EQ(read_text(precious), "precious");
    EXPECT_EQ(
        std::distance(
            std::filesystem::directory_iterator(std::filesystem::path(precious).parent_path()), {}),
        1);
    EXPECT_THROW(RecordingFile("/dev/null", true, *find_format("hdf5"), header), Error);
}

TEST(Hdf5Writing, GrowsUnderItsNameWhereThatIsAskedFor) {
    const TestFolder folder;
    StreamHeader header;
    header.width = header.height = 128;
    const auto events = some_events(3'000);
    RecordingFile file(folder.path("a.h5"), false, *find_format("hdf5"), header, Appears::growing);
    Batch batch;
    batch.events = events;
    file.write(batch);
    file.finish();
    EXPECT_TRUE(read_everything(*open_recording(folder.path("a.h5"))).events == events);
}

TEST(Hdf5, CannotBeReadFromAPipe) {
    const TestFolder folder;
    write_dsec(folder.path("a.h5"), some_events(5'000, kOffset));
    std::FILE* pipe = ::popen(("cat " + folder.path("a.h5")).c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    EXPECT_THAT(refusal("/dev/fd/" + std::to_string(::fileno(pipe))),
                AllOf(HasSubstr("HDF5"), HasSubstr("a pipe")));
    ::pclose(pipe);
}

}  // namespace
}  // namespace eventide
