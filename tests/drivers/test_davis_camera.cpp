// The real driver, through the real libusb, against a DAVIS in software.
#include "drivers/devices.h"
#include "tests/drivers/davis_streams.h"
#include "tests/drivers/usb_sessions.h"
#include "tests/support/preload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using testing_support::davis240;
using testing_support::DavisModel;
using testing_support::DavisModelSettings;
using testing_support::UsbTestbed;

/// A DAVIS240C behind FX2, with the firmware libcaer asks for.
DavisModelSettings davis240_fx2() {
    DavisModelSettings settings;
    settings.sensor = davis240();
    settings.product = kDavisFx2;
    settings.firmware = 4;
    settings.board_type = 0;
    return settings;
}

class DavisBoards : public testing::TestWithParam<bool> {
protected:
    static DavisModelSettings board() { return GetParam() ? davis240_fx2() : DavisModelSettings{}; }
};
INSTANTIATE_TEST_SUITE_P(Davis346Fx3AndDavis240Fx2, DavisBoards, testing::Bool());

TEST_P(DavisBoards, GiveTheEventsImagesAndSamplesThatTheCameraSaw) {
    PluggedIn camera_side{board(), {.events = 200'000}};
    const DavisSensor& sensor = camera_side.model->settings().sensor;
    for (const std::size_t bytes :
         {std::size_t{8} << 10, std::size_t{64} << 10, std::size_t{1} << 20}) {
        DavisOptions options = at_once();
        options.settings.transfers.bytes = bytes;
        DavisCamera camera{options};
        EXPECT_EQ(camera.info().width, sensor.width());
        EXPECT_EQ(camera.info().height, sensor.height());
        EXPECT_EQ(camera.info().serial, "00000042");
        const Streamed got = stream(camera, camera_side.bed, *camera_side.model);
        EXPECT_EQ(got.data.events, camera_side.seen.events) << "transfers of " << bytes;
        EXPECT_EQ(got.data.images, camera_side.seen.images);
        EXPECT_EQ(got.data.imu.size(), camera_side.seen.imu.size());
        EXPECT_EQ(got.damaged.total(), 0U);
        EXPECT_TRUE(got.gaps.empty());
    }
}

TEST_P(DavisBoards, EveryOrientationIsTurnedUpright) {
    for (int bits = 0; bits < 8; ++bits) {
        DavisModelSettings settings = board();
        settings.sensor.aps_swapped = (bits & 4) != 0;
        settings.sensor.aps_flip_x = (bits & 2) != 0;
        settings.sensor.aps_flip_y = (bits & 1) != 0;
        // The chip's axes, not the frame's, are exchanged with it.
        settings.sensor.dvs_swapped = settings.sensor.aps_swapped;
        PluggedIn camera_side{settings, {.events = 2'000}};
        DavisCamera camera{at_once()};
        const Streamed got = stream(camera, camera_side.bed, *camera_side.model);
        EXPECT_EQ(got.data.events, camera_side.seen.events) << "orientation " << bits;
        EXPECT_EQ(got.data.images, camera_side.seen.images) << "orientation " << bits;
    }
}

TEST(DavisCamera, ACameraInRealTimeLosesNothingAndTellsTheTimeInSilence) {
    DavisModelSettings settings;
    // A clock that moves on 1 ms each time it is looked at, and does not begin at zero.
    settings.now = [t = std::int64_t{5'000'000}]() mutable { return from_us(t += 1000); };
    PluggedIn camera_side{settings};
    DavisCamera camera{at_once()};
    const auto parser = camera.make_parser();
    Batch got;
    const SensorTime last = camera_side.seen.events.back().t;
    for (RawPacket packet; !parser->clock() || *parser->clock() < last + SensorDuration{100'000};)
        if (camera.read(packet) == ReadStatus::data) parser->parse(packet.bytes, got);
    EXPECT_EQ(got.events, camera_side.seen.events);
    EXPECT_EQ(got.images, camera_side.seen.images);
}

// There a full packet of 512 bytes begins the wait for a short one anew, so that at any but the
// lowest rate a transfer ends only when it is full.
TEST(DavisCamera, BehindUsb2NoTransferHoldsBackEventsForLong) {
    DavisModelSettings settings = davis240_fx2();
    settings.now = [t = std::int64_t{0}]() mutable { return from_us(t += 20); };
    PluggedIn camera_side{settings, {.events = 40'000, .longest_pause_us = 4}};
    DavisOptions options = at_once();
    options.settings.frames = options.settings.imu = false;
    DavisCamera camera{options};
    expect_events_held_back_less_than(SensorDuration{5'000}, camera,
                                      camera_side.seen.events.size());
}

TEST(DavisCamera, SaysWhatToDoWhenItCannotStart) {
    UsbTestbed bed;
    EXPECT_THAT(failure_of([] { DavisCamera{DavisOptions{}}; }), HasSubstr("no DAVIS found"));
    const auto with = [&](auto change) {
        DavisModelSettings settings;
        change(settings);
        bed.plug_in(std::make_shared<DavisModel>(settings));
        const std::string text = failure_of([] { DavisCamera{DavisOptions{}}; });
        bed.unplug();
        return text;
    };
    EXPECT_THAT(with([](auto& s) { s.firmware = 5; }), HasSubstr("firmware 5, at least 6"));
    EXPECT_THAT(with([](auto& s) { s = davis240_fx2(), s.firmware = 3; }),
                HasSubstr("firmware 3, at least 4"));
    EXPECT_THAT(with([](auto& s) { s.logic = 16; }), HasSubstr("logic version 16"));
    EXPECT_THAT(with([](auto& s) { s.patch = 0; }), HasSubstr("logic version 18 patch 0"));
    EXPECT_THAT(with([](auto& s) { s.logic = 9912; }), HasSubstr("another protocol"));
    EXPECT_THAT(with([](auto& s) { s.board_type = 5; }), HasSubstr("second-generation"));
    EXPECT_THAT(with([](auto& s) { s.sensor.dvs_rows = 0; }), HasSubstr("a side of 0 px"));
    EXPECT_THAT(
        with([](auto& s) { s.sensor.chip = DavisChip::davis640; }),
        HasSubstr("the DAVIS '00000042' has chip id 6 (DAVIS640), expected that of a DAVIS240A"));
    EXPECT_THAT(with([](auto& s) { s.sensor.chip = DavisChip{10}; }),
                HasSubstr("has chip id 10 (unknown), expected"));
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
    EXPECT_THAT(cameras[0].problem, HasSubstr("logic version 16"));
}

TEST_P(DavisBoards, StartAndStopAsThisGenerationOfLogicExpects) {
    using namespace davis;
    PluggedIn camera_side{board(), {.events = 100}};
    std::size_t configured = 0;
    {
        DavisCamera camera{at_once()};
        camera_side.bed.look([&] { configured = camera_side.model->writes().size(); });
        RawPacket packet;
        camera.read(packet);
    }
    std::vector<Write> writes;
    camera_side.bed.look([&] {
        const auto& all = camera_side.model->writes();
        writes.assign(all.begin() + std::ptrdiff_t(configured), all.end());
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

TEST_P(DavisBoards, AreConfiguredWithLibcaersDefaults) {
    using namespace davis;
    PluggedIn camera_side{board(), {.events = 1}};
    const DavisCamera camera{at_once()};
    const DavisSensor& sensor = camera.sensor();
    const auto value = [&](Register at) { return camera_side.model->read(at); };
    camera_side.bed.look([&] {
        // docs/protocols.md A.6 and A.7: one of each module, and where the chips differ.
        const bool fx2 = sensor.is_davis240();
        EXPECT_EQ(value({chip, std::uint16_t(fx2 ? 0 : 10)}), 0x427FU) << "DiffBn";
        EXPECT_EQ(value({chip, std::uint16_t(fx2 ? 2 : 12)}), fx2 ? 0x400FU : 0x401FU) << "OffBn";
        EXPECT_EQ(value({chip, std::uint16_t(fx2 ? 8 : 14)}), 0x23ADU) << "PrBp";
        EXPECT_EQ(value({chip, kChipConfig + 14}), 1U) << "global shutter";
        EXPECT_EQ(value(kDropDvsOnStall), 1U);
        EXPECT_EQ(value(kDvsActivityTime), 8U) << "2 ms in steps of 250 us";
        EXPECT_EQ(value(kDvsRoiEndColumn), std::uint32_t(sensor.width() - 1));
        EXPECT_EQ(value(kApsEndRow), std::uint32_t(sensor.aps_height() - 1));
        EXPECT_EQ(value(kApsExposure), 4000U * 30) << "cycles of the ADC's clock";
        EXPECT_EQ(value(kApsInterval), 40000U * 30);
        EXPECT_EQ(value(kImuAccelScale), 1U) << "+-4 g";
        EXPECT_EQ(value(kImuGyroScale), 1U) << "+-500 deg/s";
        EXPECT_EQ(value(kUsbEarlyPacketDelay), 1000U * 30) << "1 ms in cycles of the USB clock";
    });
}

TEST_P(DavisBoards, AreToldNothingThatTheyHaveNoRegisterFor) {
    using namespace davis;
    for (const int imu_type : {kNoImu, kImuMpu6050, kImuMpu6500}) {
        DavisModelSettings settings = board();
        settings.sensor.imu_type = imu_type;
        PluggedIn camera_side{settings, {.events = 1}};
        EXPECT_EQ(failure_of([] { DavisCamera{at_once()}; }), "nothing was thrown") << imu_type;
        const auto value = [&](Register at) { return camera_side.model->read(at); };
        camera_side.bed.look([&] {
            EXPECT_EQ(value(kImuAccelScale), imu_type == kNoImu ? 0U : 1U);
            EXPECT_EQ(value(kImuGyroLowPass), imu_type == kImuMpu6500 ? 1U : 0U);
            EXPECT_EQ(value({chip, kChipConfig + 15}), settings.sensor.is_davis240() ? 0U : 1U);
        });
    }
}

}  // namespace
}  // namespace eventide::test

int main(int argc, char** argv) {
    eventide::testing_support::enter_testbed(argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
