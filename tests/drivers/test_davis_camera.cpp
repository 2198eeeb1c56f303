// The real driver, through the real libusb, against a DAVIS in software.
#include "drivers/usb/davis_camera.h"
#include "src/core/error.h"
#include "tests/support/davis_model.h"
#include "tests/support/usb_testbed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
Batch stream(DavisCamera& camera, UsbTestbed& bed) {
    const auto parser = camera.make_parser();
    Batch data;
    RawPacket packet;
    for (bool over = false; !over;) {
        const ReadStatus status = camera.read(packet);
        if (status == ReadStatus::end) break;
        if (status == ReadStatus::data) parser->parse(packet.bytes, data);
        if (status == ReadStatus::timeout)
            bed.look([&](DavisModel& model) { over = model.is_scene_over(); });
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
        const Batch got = stream(camera, bed);
        EXPECT_EQ(got.events, seen.events) << "transfers of " << bytes;
        EXPECT_EQ(got.images, seen.images);
        EXPECT_EQ(got.imu.size(), seen.imu.size());
    }
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

TEST(DavisCamera, ComesBackAfterBeingUnpluggedAndMarksTheGap) {
    UsbTestbed bed;
    DavisOptions options;
    options.reconnect = true;
    std::optional<DavisCamera> camera;
    for (int cycle = 0; cycle < 5; ++cycle) {
        const auto model = std::make_shared<DavisModel>(DavisModelSettings{});
        model->show(scene(model->settings().sensor, 20'000));
        bed.plug_in(model);
        if (!camera) camera.emplace(options);
        RawPacket packet;
        while (camera->read(packet) != ReadStatus::data) continue;
        EXPECT_EQ(packet.gap_before, cycle > 0);
        bed.unplug();
        while (camera->read(packet) != ReadStatus::timeout) continue;
    }
    EXPECT_EQ(camera->counters().reconnects, 4U);
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
        bed.look([&](DavisModel& m) { configured = m.writes().size(); });
        RawPacket packet;
        camera.read(packet);
    }
    std::vector<Write> writes;
    bed.look([&](DavisModel& m) {
        writes.assign(m.writes().begin() + std::ptrdiff_t(configured), m.writes().end());
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
