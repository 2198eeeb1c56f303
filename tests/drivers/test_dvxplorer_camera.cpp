// The real driver, through the real libusb, against a DVXplorer in software with either board.
#include "drivers/usb/dvxplorer_camera.h"

#include "drivers/devices.h"
#include "tests/drivers/usb_sessions.h"
#include "tests/support/dvxplorer_model.h"
#include "tests/support/preload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <random>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using testing_support::DvxplorerModel;
using testing_support::DvxplorerModelSettings;
using testing_support::UsbTestbed;

/// Readouts of the sensor: within one time, column by column, each pixel once.
Batch readouts(const DvxplorerSensor& sensor, int count, unsigned seed = 1) {
    std::mt19937 rng{seed};
    Batch scene;
    std::int64_t t = 0;
    for (int i = 0; i < count; ++i) {
        t += 1 + std::int64_t(rng() % (i % 50 == 0 ? 90'000 : 400));
        for (int column = int(rng() % 100); column < sensor.columns();
             column += int(rng() % 97) + 1)
            for (int row = int(rng() % 60); row < sensor.rows(); row += int(rng() % 90) + 1) {
                const auto x = std::uint16_t(sensor.swapped ? row : column);
                const auto y = std::uint16_t(sensor.swapped ? column : row);
                scene.events.push_back({from_us(t), x, y, Polarity(rng() % 2)});
            }
    }
    for (int i = 1; i <= 3; ++i) {
        scene.imu.push_back({from_us(t * i / 4), {.5F, 0, 1}, {100, -20, 3}, {}, 30});
        scene.triggers.push_back({from_us(t * i / 5), Trigger::Kind::rising, 0});
    }
    return scene;
}

DvxplorerOptions at_once() {
    DvxplorerOptions options;
    options.waits = kNoWaits;
    return options;
}

struct PluggedIn {
    explicit PluggedIn(DvxplorerModelSettings settings = {}, int count = 200)
        : model(std::make_shared<DvxplorerModel>(settings)),
          seen(readouts(settings.sensor, count)) {
        model->show(seen);
        bed.plug_in(model);
    }
    UsbTestbed bed;
    std::shared_ptr<DvxplorerModel> model;
    Batch seen;
};

std::vector<DvxplorerModelSettings> boards() {
    DvxplorerModelSettings red, lite, swapped, mini;
    lite.sensor.width = 320;
    lite.sensor.height = 240;
    lite.chip = 19;
    swapped = lite;
    swapped.sensor.swapped = true;
    mini.mini = true;
    return {red, lite, swapped, mini};
}

TEST(DvxplorerCamera, GivesTheEventsThatTheCameraSawWithEachBoardAtEachTransferSize) {
    for (const auto& settings : boards()) {
        PluggedIn side{settings};
        for (const std::size_t kib : {8, 64, 1024}) {
            DvxplorerOptions options = at_once();
            options.settings.transfers.bytes = kib << 10;
            DvxplorerCamera camera{options};
            EXPECT_EQ(camera.info().width, settings.sensor.width);
            const Batch got = stream_scene(camera, side.bed, *side.model);
            EXPECT_EQ(got.events, side.seen.events) << kib << " KiB, mini " << settings.mini;
        }
    }
}

TEST(DvxplorerCamera, GivesImuSamplesInTheRangesAskedForAndTriggers) {
    PluggedIn side;
    DvxplorerOptions options = at_once();
    options.settings.accel_range_g = 16;
    options.settings.gyro_range_dps = 125;
    DvxplorerCamera camera{options};
    const Batch got = stream_scene(camera, side.bed, *side.model);
    ASSERT_EQ(got.imu.size(), 3U);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(got.imu[0].acceleration_g[axis], side.seen.imu[0].acceleration_g[axis], 1e-3);
        EXPECT_NEAR(got.imu[0].gyro_dps[axis], side.seen.imu[0].gyro_dps[axis], 1e-2);
    }
    ASSERT_EQ(got.triggers.size(), 4U);
    EXPECT_EQ(got.triggers[0].kind, Trigger::Kind::timestamp_reset);
    EXPECT_EQ(got.triggers[3], side.seen.triggers[2]);
}

TEST(DvxplorerCamera, AMinisImuComesBesideItsDataAndFallsWhereItBelongs) {
    DvxplorerModelSettings settings;
    settings.mini = settings.sensor.imu_flip_x = true;
    PluggedIn side{settings};
    side.seen.imu.clear();
    for (int i = 0; i < 500; ++i)
        side.seen.imu.push_back({from_us(i * 1250), {.5F, -1, .25F}, {float(i), -20, 3}, {}, 30});
    side.model->show(side.seen);
    for (const bool imu : {true, false}) {
        DvxplorerOptions options = at_once();
        options.settings.imu = imu;
        options.settings.accel_range_g = 4;
        DvxplorerCamera camera{options};
        const Batch got = stream_scene(camera, side.bed, *side.model);
        EXPECT_EQ(got.events, side.seen.events);
        if (!imu) {
            EXPECT_TRUE(got.imu.empty());
            continue;
        }
        // Those before the begin of time are not known yet.
        ASSERT_GE(got.imu.size(), side.seen.imu.size() - 2);
        const std::size_t missing = side.seen.imu.size() - got.imu.size();
        for (std::size_t i = 0; i < got.imu.size(); ++i) {
            const ImuSample &a = got.imu[i], &b = side.seen.imu[i + missing];
            ASSERT_NEAR(double(to_us(a.t)), double(to_us(b.t)), 1000) << i;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                ASSERT_NEAR(a.acceleration_g[axis], b.acceleration_g[axis], 1e-3);
                ASSERT_NEAR(a.gyro_dps[axis], b.gyro_dps[axis], 2e-2);
            }
        }
    }
}

TEST(DvxplorerCamera, AMiniWhoseMessagesFailStillGivesItsEvents) {
    DvxplorerModelSettings settings;
    settings.mini = true;
    for (const int error : {EPROTO, EPIPE}) {
        PluggedIn side{settings};
        side.bed.fail_messages(error);
        DvxplorerCamera camera{at_once()};
        const Batch got = stream_scene(camera, side.bed, *side.model);
        EXPECT_EQ(got.events, side.seen.events) << error;
        EXPECT_TRUE(got.imu.empty());
    }
}

TEST(DvxplorerCamera, CutsARegionOutOnTheCamera) {
    for (const bool mini : {false, true})
        for (const SensorRegion roi :
             {SensorRegion{100, 50, 200, 123}, {0, 9, 640, 3}, {3, 8, 1, 8}})
            for (const bool flipped : {false, true}) {
                DvxplorerModelSettings settings;
                settings.mini = mini;
                settings.flip_x = settings.flip_y = flipped;
                PluggedIn side{settings, 100};
                DvxplorerOptions options = at_once();
                options.settings.roi = roi;
                DvxplorerCamera camera{options};
                // The cropper works on the chip's own pixels, which a flipped sensor turns round.
                const auto inside = [&](const Event& e) {
                    const int x = flipped ? 639 - e.x : e.x, y = flipped ? 479 - e.y : e.y;
                    return x >= roi.x && x < roi.x + roi.width && y >= roi.y &&
                           y < roi.y + roi.height;
                };
                std::vector<Event> expected;
                std::copy_if(side.seen.events.begin(), side.seen.events.end(),
                             std::back_inserter(expected), inside);
                EXPECT_EQ(stream_scene(camera, side.bed, *side.model).events, expected);
                EXPECT_LT(expected.size(), side.seen.events.size());
            }
}

TEST(DvxplorerCamera, SendsOnlyThePolarityAskedFor) {
    PluggedIn side;
    DvxplorerOptions options = at_once();
    options.settings.polarity = SentPolarity::off;
    DvxplorerCamera camera{options};
    const auto off = std::count_if(side.seen.events.begin(), side.seen.events.end(),
                                   [](const Event& e) { return e.polarity == Polarity::off; });
    EXPECT_EQ(std::ptrdiff_t(stream_scene(camera, side.bed, *side.model).events.size()), off);
}

TEST(DvxplorerCamera, SaysWhatToDoWhenItCannotStart) {
    const auto with = [](auto change) {
        DvxplorerModelSettings settings;
        change(settings);
        const PluggedIn side{settings, 1};
        return words_of(ErrorKind::device, [] { DvxplorerCamera{at_once()}; });
    };
    EXPECT_THAT(with([](auto& s) { s.firmware = 7; }), HasSubstr("firmware 7, at least 8"));
    EXPECT_THAT(with([](auto& s) { s.logic = 17; }), HasSubstr("logic 17"));
    EXPECT_THAT(with([](auto& s) { s.patch = 1; }),
                HasSubstr("logic 18 patch 1, expected 18 patch 2"));
    EXPECT_THAT(with([](auto& s) { s.board_type = 5; }), HasSubstr("second-generation"));
    EXPECT_THAT(with([](auto& s) { s.sensor.width = 0; }), HasSubstr("a side of 0 px"));
}

TEST(DvxplorerCamera, ASettingThatTheCameraDoesNotTakeIsNamed) {
    DvxplorerModelSettings settings;
    settings.deaf = davis::Register{davis::chip, 0x001E};
    const PluggedIn side{settings, 1};
    EXPECT_THAT(words_of(ErrorKind::device, [] { DvxplorerCamera{at_once()}; }),
                HasSubstr("register CHIP.30 was set to 8 and says 0"));
    DvxplorerOptions trusting = at_once();
    trusting.settings.verify = false;
    EXPECT_EQ(DvxplorerCamera{trusting}.info().name, "DVXplorer");
}

TEST(DvxplorerCamera, CountsWhatTheCameraItselfDropped) {
    PluggedIn side;
    constexpr davis::Register kLow{davis::mux, 84};
    side.model->write({kLow, 1000});  // before it was started
    DvxplorerCamera camera{at_once()};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    side.bed.look([&] { side.model->write({kLow, 1007}); });
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
    EXPECT_EQ(camera.counters().device_dropped, 7U);
}

TEST(DvxplorerCamera, UnpluggedItComesBackBehindAGap) {
    for (const bool mini : {false, true}) {
        DvxplorerModelSettings settings;
        settings.mini = mini;
        PluggedIn side{settings};
        DvxplorerOptions options = at_once();
        options.reconnect = true;
        DvxplorerCamera camera{options};
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
        EXPECT_FALSE(packet.gap_before);
        side.bed.unplug();
        while (camera.read(packet) != ReadStatus::timeout) continue;
        side.bed.plug_in(side.model);
        while (camera.read(packet) != ReadStatus::data) continue;
        EXPECT_TRUE(packet.gap_before);
        EXPECT_EQ(camera.counters().reconnects, 1U);
    }
}

TEST(DvxplorerCamera, UnpluggedWithoutReconnectIsAnErrorThatNamesTheWayOut) {
    PluggedIn side;
    DvxplorerCamera camera{at_once()};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    side.bed.unplug();
    EXPECT_THAT(words_of(ErrorKind::device,
                         [&] {
                             while (camera.read(packet) != ReadStatus::end) continue;
                         }),
                HasSubstr("the DVXplorer 'DVX00001' was unplugged (use --reconnect"));
}

TEST(DvxplorerCamera, IsListedAndOpenedByItsNameOnTheCommandLine) {
    const PluggedIn side{boards()[3], 1};
    const auto cameras = list_cameras();
    ASSERT_EQ(cameras.size(), 1U);
    EXPECT_EQ(cameras[0].source, "dvxplorer:DVX00001");
    EXPECT_EQ(cameras[0].name, "DVXplorer Mini");
    EXPECT_EQ(cameras[0].firmware, "8");
    EXPECT_EQ(cameras[0].logic, "18 patch 2");
    EXPECT_EQ(cameras[0].problem, "");
    for (const char* source : {"dvxplorer:", "dvxplorer:DVX00001", "dvxplorer:1:1"})
        EXPECT_EQ(open_camera(source, {})->info().serial, "DVX00001") << source;
    EXPECT_THAT(words_of(ErrorKind::device, [] { open_camera("dvxplorer:other", {}); }),
                HasSubstr("serial 'other'"));
}

/// What was written between the settings and the end.
std::vector<davis::Write> session_of(DvxplorerModelSettings settings) {
    PluggedIn side{settings, 1};
    std::size_t configured = 0;
    {
        DvxplorerCamera camera{at_once()};
        side.bed.look([&] { configured = side.model->writes().size(); });
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
    }
    const auto& writes = side.model->writes();
    return {writes.begin() + std::ptrdiff_t(configured), writes.end()};
}

constexpr davis::Register chip(int address) {
    return {davis::chip, std::uint16_t(address)};
}

TEST(DvxplorerCamera, StartsAndStopsAsTheRedBoardExpects) {
    using namespace davis;
    // libcaer's dvXplorerDataStart, with the chip's mode off before it (its DataStop).
    const std::vector<Write> idle{{chip(0x3000), 0},
                                  {kDvsRun, 0},
                                  {kImuRunAccel, 0},
                                  {kImuRunGyro, 0},
                                  {kImuRunTemperature, 0},
                                  {kExtRun, 0},
                                  {kRun, 0},
                                  {kTimestampRun, 0},
                                  {kUsbRun, 0}};
    std::vector<Write> expected = idle;
    for (const Write w : {Write{kUsbRun, 1},
                          {kTimestampRun, 1},
                          {kRun, 1},  // the way to the host; 50 ms
                          {kDvsRun, 1},
                          {kImuRunAccel, 1},
                          {kImuRunGyro, 1},
                          {kImuRunTemperature, 1},
                          {kExtRun, 1},  // what makes data
                          {chip(0x3238), 1},
                          {chip(0x3238), 0},  // the chip's own clock
                          {chip(0x3000), 2},  // stream mode
                          {kTimestampReset, 1},
                          {kTimestampReset, 0}})  // dv-processing's handshake
        expected.push_back(w);
    expected.insert(expected.end(), idle.begin(), idle.end());
    expected.push_back({kRunChip, 0});  // libcaer's dvXplorerClose: the chip back into reset
    EXPECT_EQ(session_of({}), expected);
}

TEST(DvxplorerCamera, StartsAndStopsAsAMiniExpects) {
    using namespace davis;
    // The same without multiplexer, external input and USB module, which it has not got.
    const std::vector<Write> idle{{chip(0x3000), 0},
                                  {kDvsRun, 0},
                                  {kImuRunAccel, 0},
                                  {kImuRunGyro, 0},
                                  {kImuRunTemperature, 0}};
    std::vector<Write> expected = idle;
    for (const Write w : {Write{kDvsRun, 1},
                          {kImuRunAccel, 1},
                          {kImuRunGyro, 1},
                          {kImuRunTemperature, 1},
                          {chip(0x3238), 1},
                          {chip(0x3238), 0},
                          {chip(0x3000), 2}})
        expected.push_back(w);
    expected.insert(expected.end(), idle.begin(), idle.end());
    EXPECT_EQ(session_of(boards()[3]), expected);
}

}  // namespace
}  // namespace eventide::test

int main(int argc, char** argv) {
    eventide::testing_support::enter_testbed(argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
