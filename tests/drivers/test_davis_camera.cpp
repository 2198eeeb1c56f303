// The real driver, through the real libusb, against a DAVIS in software.
#include "drivers/devices.h"
#include "drivers/usb/davis_camera.h"
#include "src/core/error.h"
#include "tests/support/davis_model.h"
#include "tests/support/preload.h"
#include "tests/support/usb_testbed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

namespace eventide {
namespace {

using testing::HasSubstr;
using testing_support::DavisModel;
using testing_support::DavisModelSettings;
using testing_support::UsbTestbed;

/// Events, images and IMU samples over some seconds.
Batch scene(const DavisSensor& sensor, int events, unsigned seed = 1) {
    std::mt19937 rng{seed};
    Batch batch;
    std::int64_t t = 10;
    for (int i = 0; i < events; ++i) {
        t += rng() % 64 == 0 ? std::int64_t(rng() % 2000) : std::int64_t(rng() % 3);
        batch.events.push_back({from_us(t), std::uint16_t(rng() % unsigned(sensor.width())),
                                std::uint16_t(rng() % unsigned(sensor.height())),
                                Polarity(rng() % 2)});
    }
    for (int i = 1; i <= 3; ++i) {
        ReferenceImage image;
        image.exposure_begin = from_us(t * i / 4);
        image.exposure_end = image.exposure_begin + SensorDuration{4000};
        image.t = image.exposure_begin + SensorDuration{2000};
        image.pixels = Array2<std::uint16_t>{sensor.height(), sensor.width()};
        for (auto& pixel : image.pixels.values()) {
            const auto value = unsigned(rng() % 1023);
            pixel = std::uint16_t((value << 6) | (value >> 4));
        }
        batch.images.push_back(std::move(image));
        batch.imu.push_back({from_us(t * i / 5), {0, 0, 1}, {}, {}, 35});
    }
    return batch;
}

std::string failure_of(const std::function<void()>& what) {
    try {
        what();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::device);
        return error.what();
    }
    return "nothing was thrown";
}

/// Reads until the model's scene is over and nothing more comes.
Batch stream(DavisCamera& camera, UsbTestbed& bed, const DavisModel& model) {
    const auto parser = camera.make_parser();
    Batch data;
    RawPacket packet;
    for (bool over = false; !over;) {
        const ReadStatus status = camera.read(packet);
        if (status == ReadStatus::end) break;
        if (status == ReadStatus::data) parser->parse(packet.bytes, data);
        if (status == ReadStatus::timeout) bed.look([&] { over = model.is_scene_over(); });
    }
    EXPECT_EQ(parser->damaged().total(), 0U);
    return data;
}

TEST(DavisCamera, GivesTheEventsImagesAndSamplesThatTheCameraSaw) {
    UsbTestbed bed;
    const auto model = std::make_shared<DavisModel>(DavisModelSettings{});
    const Batch seen = scene(model->settings().sensor, 200'000);
    model->show(seen);
    bed.plug_in(model);
    for (const std::size_t bytes :
         {std::size_t{8} << 10, std::size_t{64} << 10, std::size_t{1} << 20}) {
        DavisOptions options;
        options.settings.transfers.bytes = bytes;
        DavisCamera camera{options};
        EXPECT_EQ(camera.info().width, 346);
        EXPECT_EQ(camera.info().serial, "00000042");
        const Batch got = stream(camera, bed, *model);
        EXPECT_EQ(got.events, seen.events) << "transfers of " << bytes;
        EXPECT_EQ(got.images, seen.images);
        EXPECT_EQ(got.imu.size(), seen.imu.size());
    }
}

TEST(DavisCamera, ACameraInRealTimeLosesNothingAndTellsTheTimeInSilence) {
    UsbTestbed bed;
    DavisModelSettings settings;
    // A clock that moves on 1 ms each time it is looked at, and does not begin at zero.
    settings.now = [t = std::int64_t{5'000'000}]() mutable { return from_us(t += 1000); };
    const auto model = std::make_shared<DavisModel>(settings);
    const Batch seen = scene(model->settings().sensor, 20'000);
    model->show(seen);
    bed.plug_in(model);
    DavisCamera camera{DavisOptions{}};
    const auto parser = camera.make_parser();
    Batch got;
    const SensorTime last = seen.events.back().t;
    for (RawPacket packet; !parser->clock() || *parser->clock() < last + SensorDuration{100'000};)
        if (camera.read(packet) == ReadStatus::data) parser->parse(packet.bytes, got);
    EXPECT_EQ(got.events, seen.events);
    EXPECT_EQ(got.images, seen.images);
}

TEST(DavisCamera, SaysWhatToDoWhenItCannotStart) {
    UsbTestbed bed;
    EXPECT_THAT(failure_of([] { DavisCamera{DavisOptions{}}; }), HasSubstr("no camera"));
    const auto with = [&](auto change) {
        DavisModelSettings settings;
        change(settings);
        bed.plug_in(std::make_shared<DavisModel>(settings));
        const std::string text = failure_of([] { DavisCamera{DavisOptions{}}; });
        bed.unplug();
        return text;
    };
    EXPECT_THAT(with([](auto& s) { s.firmware = 5; }), HasSubstr("firmware 5, at least 6"));
    EXPECT_THAT(with([](auto& s) { s.logic = 16; }), HasSubstr("logic 16"));
    EXPECT_THAT(with([](auto& s) { s.logic = 9912; }), HasSubstr("another protocol"));
    EXPECT_THAT(with([](auto& s) { s.board_type = 5; }), HasSubstr("second-generation"));
}

TEST(DavisCamera, SaysWhenNoDataCome) {
    UsbTestbed bed;
    DavisModelSettings settings;
    const auto model = std::make_shared<DavisModel>(settings);
    bed.plug_in(model);
    DavisCamera camera{DavisOptions{}};
    bed.limit_transfer(1);  // half a word at a time: the marker never shows
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }), HasSubstr("no data came"));
}

TEST(DavisCamera, BeingUnpluggedIsAnErrorThatNamesTheWayOut) {
    UsbTestbed bed;
    const auto model = std::make_shared<DavisModel>(DavisModelSettings{});
    model->show(scene(model->settings().sensor, 1000));
    bed.plug_in(model);
    DavisCamera camera{DavisOptions{}};
    RawPacket packet;
    ASSERT_EQ(camera.read(packet), ReadStatus::data);
    bed.unplug();
    EXPECT_THAT(failure_of([&] {
                    while (camera.read(packet) != ReadStatus::end) continue;
                }),
                HasSubstr("--reconnect"));
}

std::ptrdiff_t open_files() {
    return std::distance(std::filesystem::directory_iterator{"/proc/self/fd"},
                         std::filesystem::directory_iterator{});
}

TEST(DavisCamera, AHundredTimesUnpluggedItComesBackMarksTheGapAndLeaksNothing) {
    UsbTestbed bed;
    DavisOptions options;
    options.reconnect = true;
    std::optional<DavisCamera> camera;
    std::ptrdiff_t files = 0;
    for (int cycle = 0; cycle < 100; ++cycle) {
        const auto model = std::make_shared<DavisModel>(DavisModelSettings{});
        model->show(scene(model->settings().sensor, 2'000));
        bed.plug_in(model);
        if (!camera) camera.emplace(options);
        RawPacket packet;
        while (camera->read(packet) != ReadStatus::data) continue;
        EXPECT_EQ(packet.gap_before, cycle > 0);
        bed.unplug();
        while (camera->read(packet) != ReadStatus::timeout) continue;
        if (cycle == 1) files = open_files();
    }
    EXPECT_EQ(camera->counters().reconnects, 99U);
    EXPECT_EQ(open_files(), files);
}

TEST(DavisCamera, ExposureFollowsTheFrames) {
    UsbTestbed bed;
    const auto model = std::make_shared<DavisModel>(DavisModelSettings{});
    Batch dark = scene(model->settings().sensor, 1000);
    for (auto& image : dark.images)
        for (auto& pixel : image.pixels.values()) pixel = 64 << 6 | 64 >> 4;
    model->show(dark);
    bed.plug_in(model);
    DavisCamera camera{DavisOptions{}};
    stream(camera, bed, *model);
    RawPacket packet;
    camera.read(packet);
    bed.look([&] { EXPECT_EQ(model->read(davis::kApsExposure), 30U * 8000); });  // 4 ms, doubled
}

TEST(DavisExposure, GoesWhereTheMeanIsRightAndStaysThere) {
    // A linear sensor: brightness follows exposure until it saturates.
    for (const double light : {0.00001, 0.0003, 0.01}) {  // full scales per us
        int exposure_us = 4000;
        ReferenceImage frame;
        frame.pixels = Array2<std::uint16_t>{2, 2};
        int changes = 0;
        for (int i = 0; i < 40; ++i) {
            const double value = std::min(1.0, light * exposure_us);
            for (auto& pixel : frame.pixels.values()) pixel = std::uint16_t(value * 65535);
            const int next = better_exposure_us(frame, exposure_us);
            changes += next != exposure_us && i > 30 ? 1 : 0;
            exposure_us = next;
        }
        EXPECT_NEAR(light * exposure_us, 0.4, 0.07);
        EXPECT_EQ(changes, 0) << "it hunts";
    }
}

TEST(DavisSettings, ShippedFileSaysTheDefaults) {
    const DavisSettings shipped = load_davis_settings(std::filesystem::path{EVENTIDE_SOURCE_DIR} /
                                                      "config/cameras/davis346.toml");
    const DavisSensor sensor;
    EXPECT_EQ(configuration(shipped, sensor, {}), configuration(DavisSettings{}, sensor, {}));
}

TEST(DavisSettings, RefusesWhatItDoesNotKnowWithItsLine) {
    const auto refusal = [](const std::string& text) {
        const auto file = std::filesystem::path{testing::TempDir()} / "camera.toml";
        std::ofstream{file} << text;
        try {
            load_davis_settings(file);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            return std::string{error.what()};
        }
        return std::string{"accepted"};
    };
    EXPECT_THAT(refusal("imu = true\nexposure = 3\n"),
                HasSubstr("camera.toml:2: unknown key 'exposure'"));
    EXPECT_THAT(refusal("accel_range_g = 5"), HasSubstr("one of 2, 4, 8, 16, found 5"));
    EXPECT_THAT(refusal("exposure_us = -1"), HasSubstr("from 0 to 4194303, found -1"));
    EXPECT_THAT(refusal("frames = 1"), HasSubstr("true or false"));
    EXPECT_THAT(refusal("= 1"), HasSubstr("camera.toml:1"));
    DavisSettings settings;
    settings.biases["NoSuchBias"] = 1;
    EXPECT_THROW(configuration(settings, DavisSensor{}, {}), Error);
}

TEST(Devices, ListsWhatIsPluggedInAndWhyItCannotBeUsed) {
    UsbTestbed bed;
    EXPECT_TRUE(list_cameras().empty());
    bed.plug_in(std::make_shared<DavisModel>(DavisModelSettings{}));
    auto cameras = list_cameras();
    ASSERT_EQ(cameras.size(), 1U);
    EXPECT_EQ(cameras[0].source, "davis:00000042");
    EXPECT_EQ(cameras[0].name, "DAVIS346B");
    EXPECT_EQ(cameras[0].problem, "");
    EXPECT_EQ(open_camera(cameras[0].source, {})->info().serial, "00000042");
    EXPECT_EQ(open_camera("davis:1:1", {})->info().serial, "00000042");
    EXPECT_THAT(failure_of([] { open_camera("davis:other", {}); }), HasSubstr("serial 'other'"));
    bed.unplug();
    DavisModelSettings old;
    old.logic = 16;
    bed.plug_in(std::make_shared<DavisModel>(old));
    cameras = list_cameras();
    ASSERT_EQ(cameras.size(), 1U);
    EXPECT_THAT(cameras[0].problem, HasSubstr("logic 16"));
}

TEST(DavisCamera, StartsAndStopsAsThisGenerationOfLogicExpects) {
    using namespace davis;
    UsbTestbed bed;
    const auto model = std::make_shared<DavisModel>(DavisModelSettings{});
    model->show(scene(model->settings().sensor, 100));
    bed.plug_in(model);
    std::size_t configured = 0;
    {
        DavisCamera camera{DavisOptions{}};
        bed.look([&] { configured = model->writes().size(); });
        RawPacket packet;
        camera.read(packet);
    }
    std::vector<Write> writes;
    bed.look([&] {
        writes.assign(model->writes().begin() + std::ptrdiff_t(configured), model->writes().end());
    });
    // libcaer's davisDataStart: all off; bias generator; 200 ms; USB, timestamps, multiplexer; 50
    // ms; the data makers; then dv-processing's timestamp reset, whose marker is waited for;
    // davisDataStop: all off again.
    const std::vector<Write> idle{
        {kDvsRun, 0}, {kApsRun, 0}, {kImuRunAccel, 0},  {kImuRunGyro, 0}, {kImuRunTemperature, 0},
        {kExtRun, 0}, {kRun, 0},    {kTimestampRun, 0}, {kUsbRun, 0},     {kRunChip, 0}};
    std::vector<Write> expected = idle;
    for (const Write w : {Write{kRunChip, 1},
                          {kUsbRun, 1},
                          {kTimestampRun, 1},
                          {kRun, 1},
                          {kDvsRun, 1},
                          {kApsRun, 1},
                          {kImuRunAccel, 1},
                          {kImuRunGyro, 1},
                          {kImuRunTemperature, 1},
                          {kExtRun, 1},
                          {kTimestampReset, 1},
                          {kTimestampReset, 0}})
        expected.push_back(w);
    expected.insert(expected.end(), idle.begin(), idle.end());
    EXPECT_EQ(writes, expected);
}

}  // namespace
}  // namespace eventide

int main(int argc, char** argv) {
    eventide::testing_support::enter_testbed(argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
