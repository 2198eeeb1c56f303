// What a DAVIS is told: the settings file, and the exposure that follows the frames.
#include "drivers/usb/davis_exposure.h"
#include "drivers/usb/davis_settings.h"
#include "src/core/error.h"
#include "tests/drivers/davis_streams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace eventide::test {
namespace {

using testing::HasSubstr;

Batch dark(const DavisSensor& sensor) {
    Batch scene = davis_scene(sensor, {.events = 1000});
    for (auto& image : scene.images)
        for (auto& pixel : image.pixels.values()) pixel = 64 << 6 | 64 >> 4;
    return scene;
}

TEST(DavisExposure, FollowsTheFramesAndIsKeptWhenTheCameraComesBack) {
    PluggedIn camera_side;
    camera_side.model->show(dark(camera_side.model->settings().sensor));
    DavisOptions options = at_once();
    options.reconnect = true;
    DavisCamera camera{options};
    stream(camera, camera_side.bed, *camera_side.model);
    RawPacket packet;
    camera.read(packet);
    const auto exposure = [](PluggedIn& side) {
        std::uint32_t cycles = 0;
        side.bed.look([&] { cycles = side.model->read(davis::kApsExposure); });
        return cycles;
    };
    EXPECT_EQ(exposure(camera_side), 30U * 8000) << "4 ms, doubled";
    camera_side.bed.unplug();
    camera_side.model =
        std::make_shared<testing_support::DavisModel>(testing_support::DavisModelSettings{});
    camera_side.bed.plug_in(camera_side.model);
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_EQ(exposure(camera_side), 30U * 8000);
}

TEST(DavisExposure, IsAskedForAgainWhereTheCameraRefusesItButNotForEver) {
    for (const int refusals : {1, 2, 3}) {
        PluggedIn camera_side;
        camera_side.model->show(dark(camera_side.model->settings().sensor));
        DavisCamera camera{at_once()};
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
        camera_side.bed.stall_control(refusals);
        const auto go_on = [&] {
            stream(camera, camera_side.bed, *camera_side.model);
            for (int i = 0; i < refusals; ++i) camera.read(packet);
        };
        if (refusals == 3) {
            EXPECT_THAT(failure_of(go_on), HasSubstr("the camera refused the request"));
            continue;
        }
        go_on();
        std::uint32_t cycles = 0;
        camera_side.bed.look([&] { cycles = camera_side.model->read(davis::kApsExposure); });
        EXPECT_EQ(cycles, 30U * 8000) << refusals;
    }
}

/// Gives a parser dark frames, each time a second later; it asks for another exposure then.
class Darkness {
public:
    explicit Darkness(const DavisSensor& sensor) : writer_{sensor} {
        images_.images = dark(sensor).images;
    }
    void show(Parser& parser) {
        std::vector<std::byte> bytes;
        writer_.write(images_, bytes);
        Batch parsed;
        parser.parse(bytes, parsed);
        for (ReferenceImage& image : images_.images)
            for (SensorTime* t : {&image.t, &image.exposure_begin, &image.exposure_end})
                *t += std::chrono::seconds{1};
    }

private:
    Batch images_;
    testing_support::DavisWriter writer_;
};

TEST(DavisExposure, RefusalsThatLieApartNeverAddUp) {
    PluggedIn camera_side;
    Darkness darkness{camera_side.model->settings().sensor};
    DavisCamera camera{at_once()};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    const auto parser = camera.make_parser();
    for (int round = 0; round < 2; ++round) {
        darkness.show(*parser);
        camera_side.bed.stall_control(2);
        for (int i = 0; i < 3; ++i) camera.read(packet);
        std::uint32_t cycles = 0;
        camera_side.bed.look([&] { cycles = camera_side.model->read(davis::kApsExposure); });
        EXPECT_EQ(cycles, 30U * (round == 0 ? 8000 : 16'000));
    }
}

TEST(DavisExposure, RefusedForGoodTheCameraIsOpenedAgainEachTime) {
    PluggedIn camera_side;
    Darkness darkness{camera_side.model->settings().sensor};
    DavisOptions options = at_once();
    options.reconnect = true;
    DavisCamera camera{options};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    const auto parser = camera.make_parser();
    for (int round = 0; round < 2; ++round) {
        darkness.show(*parser);
        camera_side.bed.stall_control(3);
        for (int i = 0; i < 6; ++i) camera.read(packet);
        EXPECT_EQ(camera.counters()[CameraCount::reconnects], std::uint64_t(round + 1));
    }
}

TEST(DavisExposure, OnlyOneOfTwoParsersAdjustsIt) {
    PluggedIn camera_side;
    const DavisCamera camera{at_once()};
    const auto recorder = camera.make_parser();
    const auto line = camera.make_parser();
    EXPECT_NE(dynamic_cast<ExposingDavisParser*>(recorder.get()), nullptr);
    EXPECT_EQ(dynamic_cast<ExposingDavisParser*>(line.get()), nullptr);
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

TEST(UsbStreamSettings, FitTheBusWhereNothingElseIsSaid) {
    const auto all = [](const UsbStreamSettings& s) { return std::pair{s.transfers, s.bytes}; };
    EXPECT_EQ(all(fitting({}, true)), std::pair(32, std::size_t{128} << 10));
    EXPECT_EQ(all(fitting({}, false)), std::pair(128, std::size_t{8} << 10));
    EXPECT_EQ(all(fitting({16, 4096}, false)), std::pair(16, std::size_t{4096}));
    EXPECT_EQ(all(fitting({0, 1 << 20}, false)), std::pair(32, std::size_t{1} << 20))
        << "128 of them would need 128 MiB";
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

}  // namespace
}  // namespace eventide::test
