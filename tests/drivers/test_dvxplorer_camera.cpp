// The real driver, through the real libusb, against a DVXplorer in software with either board.
#include "drivers/devices.h"
#include "tests/drivers/dvxplorer_boards.h"
#include "tests/support/preload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace eventide::test::dvxplorer {
namespace {

using testing::HasSubstr;
using testing_support::DvxplorerModelSettings;

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

TEST(DvxplorerCamera, DelaysAreCountedInTheClocksThatItSays) {
    PluggedIn side{{}, 1};
    side.model->write({davis::kUsbMhz, 60});
    side.model->write({davis::kLogicMhz, 50});
    side.model->write({davis::kClockDeviation, 500});  // per mille
    DvxplorerOptions options = at_once();
    options.settings.early_packet_delay_us = 100;
    const DvxplorerCamera camera{options};
    EXPECT_EQ(side.model->read(davis::kUsbEarlyPacketDelay), 100U * 60 / 2);
    EXPECT_EQ(side.model->read(davis::kExtPulseLength), 10U * 50 / 2);
}

TEST(DvxplorerCamera, OnlyAGeneratorThatIsThereIsSwitchedOff) {
    for (const bool has_one : {true, false}) {
        PluggedIn side{{}, 1};
        side.model->write({davis::kExtHasGenerator, has_one ? 1U : 0U});
        const DvxplorerCamera camera{at_once()};
        const auto& writes = side.model->writes();
        EXPECT_EQ(std::ranges::count(writes, davis::kExtGeneratorRun, &davis::Write::at),
                  has_one ? 1 : 0);
    }
}

TEST(DvxplorerCamera, OnlyTheRedBoardIsAskedForItsDrops) {
    constexpr davis::Register kDroppedLow{davis::mux, 84};
    for (const bool mini : {false, true}) {
        DvxplorerModelSettings settings;
        settings.mini = mini;
        PluggedIn side{settings, 20};
        DvxplorerCamera camera{at_once()};
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
        side.bed.look([&] { side.model->write({kDroppedLow, 7}); });
        camera.stop();
        EXPECT_EQ(camera.read(packet), ReadStatus::end);
        EXPECT_EQ(camera.counters()[CameraCount::dropped_events], mini ? 0U : 7U);
    }
}

TEST(DvxplorerCamera, EachAxisOfItsImuMayBeTurnedRound) {
    for (const auto turned : {&DvxplorerSensor::imu_flip_x, &DvxplorerSensor::imu_flip_y,
                              &DvxplorerSensor::imu_flip_z}) {
        DvxplorerModelSettings settings;
        settings.sensor.*turned = true;
        PluggedIn side{settings, 20};
        DvxplorerCamera camera{at_once()};
        const Batch got = stream_scene(camera, side.bed, *side.model);
        ASSERT_EQ(got.imu.size(), 3U);
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(got.imu[0].gyro_dps[axis], side.seen.imu[0].gyro_dps[axis], 1e-1);
    }
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

TEST(DvxplorerCamera, CutsARegionOutOnTheCamera) {
    for (const bool mini : {false, true})
        for (const SensorRegion roi :
             {SensorRegion{100, 50, 200, 123}, {0, 9, 640, 3}, {3, 8, 1, 8}})
            for (const auto& [flip_x, flip_y] :
                 {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
                DvxplorerModelSettings settings;
                settings.mini = mini;
                settings.flip_x = flip_x;
                settings.flip_y = flip_y;
                PluggedIn side{settings, 100};
                DvxplorerOptions options = at_once();
                options.settings.roi = roi;
                DvxplorerCamera camera{options};
                // The cropper works on the chip's own pixels, which a flipped sensor turns round.
                const auto inside = [&, &mirrored = settings](const Event& e) {
                    const int x = mirrored.flip_x ? 639 - e.x : e.x,
                              y = mirrored.flip_y ? 479 - e.y : e.y;
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

TEST(DvxplorerCamera, LeavesOutRowsAndColumnsOnTheCamera) {
    for (const auto& settings : boards())
        for (const int subsample : {1, 2, 4}) {
            PluggedIn side{settings, 100};
            DvxplorerOptions options = at_once();
            options.settings.subsample = subsample;
            DvxplorerCamera camera{options};
            std::vector<Event> expected;
            std::copy_if(
                side.seen.events.begin(), side.seen.events.end(), std::back_inserter(expected),
                [&](const Event& e) { return e.x % subsample == 0 && e.y % subsample == 0; });
            EXPECT_EQ(stream_scene(camera, side.bed, *side.model).events, expected)
                << "1/" << subsample << " of chip " << settings.chip;
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
    EXPECT_THAT(error_of([] { open_camera("dvxplorer:other", {}); }, ErrorKind::device),
                HasSubstr("serial 'other'"));
}

}  // namespace
}  // namespace eventide::test::dvxplorer

int main(int argc, char** argv) {
    eventide::testing_support::enter_testbed(argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
