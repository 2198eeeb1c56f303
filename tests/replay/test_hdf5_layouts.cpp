// HDF5 recordings: each layout gives back the events that were written into it.
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "src/simulate/sim_recording.h"
#include "tests/replay/hdf5_files.h"
#include "tests/replay/hdf5_layouts.h"
#include "tests/replay/recording_files.h"

#include <gmock/gmock.h>

namespace eventide {
namespace {

struct Layout {
    const char* name;
    void (*write)(const std::string&, const std::vector<Event>&);
    int width, height;
};

class Hdf5Layouts : public testing::TestWithParam<Layout> {
protected:
    const TestFolder folder_;
    const std::vector<Event> events_ = some_events(50'000, test::kDsecOffset + 700, 20, 240, 180);
    std::string path() const {
        GetParam().write(folder_.path("a.h5"), events_);
        return folder_.path("a.h5");
    }
};

INSTANTIATE_TEST_SUITE_P(All, Hdf5Layouts,
                         testing::Values(Layout{"DSEC", test::write_dsec, 240, 180},
                                         Layout{"M3ED", test::write_m3ed, 1280, 720},
                                         Layout{"MVSEC", test::write_mvsec, 346, 260},
                                         Layout{"Prophesee", test::write_prophesee, 1280, 720},
                                         Layout{"event_utils", test::write_event_utils, 240, 180},
                                         Layout{"e2calib", test::write_e2calib, 240, 180},
                                         Layout{"eventide", test::write_hdf5, 640, 480}),
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
    const SensorDuration by = from_us(test::kDsecOffset + 700) - events.front().t;
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
        if (known.on > 0) {
            EXPECT_EQ(sum.on, known.on) << known.path;
        }
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

/// Of stereo recordings.
TEST(Hdf5Layout, OfAPairTheLeftOneIsReadOrTheOneThatIsWanted) {
    const TestFolder folder;
    const std::vector<std::int64_t> times{10, 20};
    const std::vector<std::uint8_t> polarities{1, 0};
    {
        const test::Hdf5Made mvsec(folder.path("mvsec.h5")), m3ed(folder.path("m3ed.h5"));
        for (const std::string side : {"left", "right"}) {
            const unsigned x = side == "left" ? 1 : 101;
            const std::vector<double> rows{double(x), 2, 1.5e9, 1, 3, 4, 1.5e9 + 1e-3, -1};
            const std::vector<std::uint16_t> places{std::uint16_t(x), 3};
            mvsec.array("davis/" + side + "/events", {2, 4}, H5T_NATIVE_DOUBLE, rows.data(),
                        H5T_IEEE_F64LE);
            const std::string camera = "prophesee/" + side + "/";
            m3ed.column(camera + "x", places, H5T_STD_U16LE);
            m3ed.column(camera + "y", places, H5T_STD_U16LE);
            m3ed.column(camera + "t", times, H5T_STD_I64LE);
            m3ed.column(camera + "p", polarities, H5T_STD_U8LE);
        }
    }
    const auto first_x = [&](const char* file, const std::string& stream) {
        const OpenOptions options{.width = 1280, .height = 720, .stream = stream};
        return int(read_everything(*open_recording(folder.path(file), options)).events.at(0).x);
    };
    const auto remarks = [&](const char* file, const std::string& stream) {
        const OpenOptions options{.width = 1280, .height = 720, .stream = stream};
        return open_recording(folder.path(file), options)->remarks();
    };
    const std::string how = " (the option stream of the library) reads those";
    for (const auto& [file, cameras] : {std::pair{"mvsec.h5", "davis"}, {"m3ed.h5", "prophesee"}}) {
        const std::string left = std::string(cameras) + "/left",
                          right = std::string(cameras) + "/right";
        EXPECT_EQ(first_x(file, ""), 1) << file;
        EXPECT_EQ(first_x(file, left), 1) << file;
        EXPECT_EQ(first_x(file, right), 101) << file;
        EXPECT_THAT(remarks(file, ""),
                    testing::ElementsAre("the events of " + right + " are left out, those of " +
                                         left + " are read; --input-stream " + right + how));
        EXPECT_THAT(remarks(file, right),
                    testing::ElementsAre("the events of " + left + " are left out, those of " +
                                         right + " are read; --input-stream " + left + how));
        try {
            first_x(file, "right");
            FAIL();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_THAT(error.what(),
                        testing::HasSubstr("expected the events of 'right', found those of " +
                                           left + ", " + right));
        }
    }
}

}  // namespace
}  // namespace eventide
